"""The integers that all kernels of a flow get, by their places; offsets are into the floats but for AT.

Faces of all components stand one after another, those of x first; "by face" are arrays of one number each in that
order, "by cell" of one number a cell. Edges are where a velocity along a side of the box is given: beside a wall.
"""

CELLS, PERIODIC = 0, 3
"""Cells along x, y, z, and 1 where periodic."""
AXES, AT, STARTS, FACES = 6, 7, 8, 11
"""Number of axes; the first face in y; the first face of each component, and the number of all."""
AREAS, SCALES, INVERSES, MOVES = 12, 13, 14, 15
"""By face: area; area over volume, and 1/volume, both 0 where the velocity is given; its rate where it is given."""
VISCOUS = 16
"""By face, along x, y, z: conductance of viscosity to the face before it, over the density [m^3/s]."""
EDGES, EDGE_VALUES, EDGE_WEIGHTS = 19, 20, 21
"""Number of edges; the velocity at each, and the conductance from the face beside it [m^3/s]."""
SCHEME, SKIP, PRESSURE, WORK = 22, 23, 24, 25
"""Advection; not 0: no projection; by cell: pressure over density; scratch."""
CONDUCTANCES, SINK = 26, 29
"""By cell along x, y, z: of the pressure's equation, with the face on the low side; where the pressure is 0."""
ITERATES, SINGULAR, SPECTRUM = 30, 31, 32
"""1: iterations, with the transform and CUT as preconditioner, 2: a linear solver by name; 1: pressure up to a
constant; by cell: 1/eigenvalue, or of flat boxes the store of lines_kernels."""
PUSHES = 33
"""By face: acceleration by given forces and pressures."""
FRICTION = 34
"""By face: conductance of viscosity to the walls of solids in its own cell."""
OWNERS = 35
"""By face, then by cell: the number of the nearest solid."""
FILLS = 36
"""By face: how far a force moves its own cell, whose inertia is that of more fluid where a solid leaves it little."""
CUT = 37
"""By cell that solids or half open sides cut: 1/(2 its own entry of the pressure's equation); else 0."""
GAINS = 38
"""By face: what the walls of solids add by their own velocity [m^4/s^2]."""
SEEPING = 39
"""By cell: what walls that move push through its open faces [m^3/s]; -1: none moves."""
MIDDLES, CUT_FACES = 40, 41
"""Faces that solids cut, then x, y, z of the middles of what is open of them [m]; their number."""
SOLVER_AT, STORE, STORE_SIZE = 42, 43, 44
"""Where in these integers the plan of a linear solver by name begins (grids/multigrid/linear_kernels); its store, after
one number a cell; floats of the store."""
LED = 45
"""By cell where solids move: what they leave of it (0: none moves); the rate of what their walls push [m^3/s^2] is then
by cell after SEEPING, and then what all push into a closed box, in parts of what they push at all."""
UNCUT = 46
"""Along x, y, z: the conductance of a face of the box in the pressure's equation."""
PUSHED, GIVEN = 47, 48
"""1 where something pushes, and where the velocities of some faces are given."""
PLAIN = 49
"""1 where the open areas of a component's faces are all the same at all times, and, but on the boundary, their
volumes."""
PLANS, PLAN = 50, 24
"""Of each axis PLAN integers."""
KIND, LENGTH, TWIDDLES, TWISTS, FACTORS = 0, 1, 2, 3, 4
"""Of a plan: the modes; length of the Fourier transform; cosines and sines of 2 pi k/length, then of pi k/(2 length);
number of factors of the length, and these."""
EDGE_FIRST = PLANS + 3 * PLAN
"""The first edge of component a on the low (0) or high (1) side of axis b: at EDGE_FIRST + 6 a + 2 b + side, or -1."""
EDGE_FACES = EDGE_FIRST + 18
"""The face of each edge."""

COSINES, SINES, QUARTER_COSINES, QUARTER_SINES, WAVES, NODES, NODES_FREE, FREE_NODES, FREE_FREE = range(9)
"""Modes of an axis. Of values at centers: none crosses the ends, 0 at both, none crosses and then 0, 0 and then none
crosses; periodic. Of values at faces, with those at both ends: 0 there, 0 and then free, free and then 0, free."""
UPWIND, CENTRAL, KOREN = range(3)
CHANGE, VELOCITY, RATE = range(3)
"""What loses its divergence: a change of velocities or of rates, through which walls push nothing; velocities; their
rates."""
LANES = 8
"""Pairs of rows that are transformed side by side: as many as numbers in a lane, and in a line of memory."""
BOTH = 2 * LANES
"""The rows of all pairs: real and imaginary parts of complex numbers."""
PAD = 24
"""Numbers between arrays that are read side by side: three lines of memory."""
