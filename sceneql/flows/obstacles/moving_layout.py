"""The integers of the kernels that cut a flow's cells anew where solids move; offsets are into the floats.

"By face" and "by cell" are as in flows/layout. After HEAD integers come the solids' surfaces (contacts/shape_kernels),
then the flow's own integers.
"""

SOLIDS, FLOW = 0, 1
"""Number of solids, moving or not; where the flow's integers begin."""
TIES = 2
"""By face, along x, y, z: viscous ties of the uncut box to the face before [m^3/s]."""
AREAS, VOLUMES, GIVEN, OUTSIDE = 5, 6, 7, 8
"""By face, of the uncut box: areas, volumes, 1 where the velocity is given, accelerations by the pressure outside."""
BASE, WEIGHTS = 9, 10
"""By face: accelerations without the force that a script gives, and what that is multiplied with; -1: there is none."""
EDGE_WEIGHTS = 11
"""By edge, of the uncut box (flows/layout)."""
SINKS, SOLVED = 12, 13
"""By face: what viscosity takes beside its ties, volumes that are solved for (system.Grid)."""
LEVELS, PARTS, DEPTHS, CENTERS, NORMALS, SCALES, FIXED = 14, 15, 16, 17, 20, 23, 24
"""By face: distance of its middle from the nearest solid; open part, its mean distance, its middle, the normal there
(x, y, z: an array each); the velocity at the face's middle over that of its open part of a wall at rest, and what a
moving wall adds."""
CELL_PARTS, WHOLE = 25, 26
"""By cell: its open part; the least volume (LEAST) or more of the cells that fluid is left in, of whole ones."""
HELD = 27
"""By cell: sinks of the pressure's equation as a linear solver by name sees them; -1: none is named."""
NUMBERS = 28
"""Low corner and sides of a cell (6 floats), the density, the largest rate of viscosity's explicit steps [1/s], an
uncut cell's own entry of the pressure's equation [m], the largest ties along x, y, z summed [m^3/s]."""
OPENING, RATES, SHUT = 29, 30, 31
"""By face how fast its open part grows [m^2/s]; by cell the rate of what walls push through it by their acceleration
[m^3/s^2]; by face 1 where it was shut when the last step ended."""
HEAD = 32
LOW, SPACING, DENSITY, FASTEST, ENTRY, DRAW = 0, 3, 6, 7, 8, 9
"""Places in NUMBERS."""
