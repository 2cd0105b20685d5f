"""The integers that kernels of skins get, by their places; offsets are into the floats but for POSITION_AT."""

COUNT, POSITION_AT, FORCE_AT = 0, 1, 2
"""Of all of them: vertices, the first one's place in y, the first one's force [N]."""

BOX_AT, DENSITY_AT, PESKIN, MODE_AT, FLOW = 3, 4, 5, 6, 7
"""Of what ties a skin to a flow: low corner and sides of a cell (6 floats), density, or in a flow of several fluids by
face the mass in its own cell; 1 for Peskin's kernel of four points, 0 for splines; fluid_layout.MODE (-1 in
a flow of one fluid); from FLOW on the flow's integers
(flows/layout.py)."""

PRETENSION_AT, STIFFNESS_AT, LENGTHS_AT, MODULUS_AT, HELD_AT = 3, 4, 5, 6, 7
"""Of the tension of a closed line: its tension where it has its own lengths, by how much it grows for a relative
stretch [N]; these lengths [m], of the side from each vertex to the next; two more numbers, of rubber and of Skalak's
law [N]; 1 where a solver has found what sides pull at the vertices where they begin, then this [N] (2)."""

VOLUME_AT, NORMALS_AT, TALLY_AT, DEPTH_AT = 3, 4, 5, 6
"""Of what keeps its volume: that volume [m^3]; room for three floats a vertex; the entry of y that sums what was put
back [m^3]; the depth of a flat flow [m]."""

REST_AT, SIDES, CORNERS = 4, 5, 7
"""Of the laws of a sheet: at PRETENSION_AT its tension, the stiffness of each side, or the modulus (and how much it
resists a change of area) [N/m]; at REST_AT of each side its own length [m], or of each triangle the inverse of its
sides in its own plane (p, q; 0, r) [1/m] and its area [m^2], at the start. From SIDES on the two vertices of each side,
from CORNERS on the three of each triangle, of what keeps its volume too."""

BEND_AT, SUMS_AT, FACES, FOLDS = 3, 4, 5, 6
BENT_HELD_AT = 4
"""Of bending: its stiffness [N m], of a line times the depth [N m^2] and then
HELD_AT of its tension; of a sheet room for two floats a vertex, the
number of its sides, and from FOLDS on of each its two vertices and those across from it; then the three of each
triangle."""
