"""The integers of the kernels of a flow whose density or viscosity varies; offsets are into the floats.

Halves are the cells of a grid twice as fine: each of a component's own cells, of the cells around centers and of those
around edges is made of whole ones. "By face", "by cell" and "by edge" are as in flows/layout.
"""

FLOW = 0
"""Where the flow's own integers begin (flows/layout.py); its viscous numbers are those of a viscosity of 1 m^2/s."""
OWN = 1
"""Density [kg/m^3] and viscosity [Pa s] of the flow's own fluid, then low corner and sides of a cell (8 floats)."""
TABLE = 2
"""How many other fluids there are, and where their rows begin, of ROW floats each (2 floats)."""
BASE = 3
"""Viscosity of the own fluid where that is a formula: by cell, of the halves at one place in their cells after another;
-1: it is one number."""
DENSITY, MEAN, FLUIDITY = 4, 5, 6
"""By half: density, viscosity [Pa s], and the mean of 1/viscosity."""
PART, COVER = 7, 8
"""By half: what the fluid that is measured fills of it; of its row beyond it."""
MASSES = 9
"""By face: mass in its own cell [kg]; then what it would be without solids."""
NORMAL, SHEAR, SHEARS = 10, 11, 12
"""Viscosity by cell; by edge within, those in the planes x y, x z, y z one after another; where these begin (3)."""
WALLS = 15
"""By edge at walls (flows/layout EDGES): viscosity."""
WEIGHT = 16
"""The acceleration by gravity (3 floats)."""
MODE = 17
"""What the terms do: one of the three below (1 float)."""
MOMENTUM, MASS = 18, 19
"""By face: how fast momentum comes into its own cell [N], and mass [kg/s]."""
HELD = 20
"""By cell: sinks of the pressure's equation as a linear solver by name sees them; -1: none is named."""
UNEQUAL = 21
"""1 where densities are unequal, and with them the pressure's equation."""
FASTEST = 22
"""The largest angular velocity of waves of skins (1 float) [1/s]."""
CLIPPED = 23
"""Room for the polygons that a deep skin is cut into."""
LEFT = 24
"""By face: what solids leave of its own cell's inertia, then of its viscous ties along x, y and z; -1: none stands."""
DRAGS = 25
"""By face: newtons by velocity that walls of solids take [kg/s]."""
LINES = 26
"""Room for four rows of halves (halves_kernels.py)."""
ANEW = 27
"""1 where coefficients follow from more than the places of skins, so that they are computed for every rate."""
HEAD = 28

COUNT, POSITION_AT, TRIANGLES, CORNERS_AT, ITS_DENSITY, ITS_VISCOSITY, KNOWN_AT, ROW = range(8)
"""Of a fluid's row: vertices of its skin, the first one's place in y, triangles (0: a closed line), offset of the three
numbers of vertices of each, density [kg/m^3], viscosity [Pa s], offset of the places (vertices, 3) that coefficients
were computed for."""

WHOLE, MOTION, FORCES = 0.0, 1.0, 2.0
"""Of MODE: all of the rate; what flows of mass and momentum bring, in MOMENTUM and MASS alone; all but that."""
