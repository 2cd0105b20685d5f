"""The integers and the memory of the barrier between skins: indices by name."""

VERTICES, TRIANGLES, EDGES, LIST, NUMBERS, FRICTION, AREAS, STIFFNESS, REST = range(9)
(
    MEMORY,
    POINTS_AT,
    MOST_POINTS,
    EDGES_AT,
    MOST_EDGES,
    GRID_AT,
    CELLS,
    LAG_AT,
    MOST_LAGGED,
    LAGGED_BEFORE,
    LOADS,
    NOW,
    RIGID,
    PLACES,
    HEAD,
) = range(9, 24)
"""Numbers of VERTICES, TRIANGLES, EDGES of all skins; at LIST, in these integers: VERTEX integers for a vertex, three
vertices for each triangle, two for each edge.

Offsets in the floats: of NUMBERS, of the coefficient of friction, of the AREAS [m^2] of vertices, then edges, of the
STIFFNESS [Pa] of vertices, of the places of vertices at the start (3), of the MEMORY; of pairs of a vertex and a
triangle, and how many there is room for; likewise of two edges; of the scratch of the grid, and its number of CELLS; of
what friction has lagged, for how many pairs there is room, of those of the step before, of the loads on the
vertices (behind those before), and of where vertices are (3) at the state that is looked at: NOW; behind that (3) at
the end of a change, and how far (1) its turning takes the vertex at most [m].

RIGID: the number of vertices of rigid bodies.

At PLACES, in these integers: the first place of each vertex's row and the end, then the column of each place; where
there are rigid bodies, of each carrier (carried_slopes_kernels.py)."""

POSITION, VELOCITY, WORK, INVERSE, ROTATION, MOMENTUM, INERTIA, ARM, BODY, HELD, VERTEX = *range(10), 12
"""A vertex: the integers of its system.Place, with an ARM on a rigid body; its solid, whether each component is
held (1). A mass that was pinned when the Jacobian was laid out has PINNED at HELD."""

PINNED = 2

GAP, SLIP, SIDE = range(3)
"""NUMBERS: the gap, speed of slip, mean side of the triangles."""

BUILT, MARGIN, POINT_PAIRS, EDGE_PAIRS, LAGS, STAGES, LAGGED, CROWDED, SCRATCH = range(9)
AT = SCRATCH + 12
"""MEMORY: 1 where pairs were looked for, the way [m] that vertices may go until they are looked for anew, numbers of
pairs, channels.LAGS and channels.STAGES for which LAGGED pairs hold, how many times there was no room; scratch (12),
then the places (3) of the vertices when pairs were looked for."""

NODES, WEIGHTS, NORMAL, LOAD, FRICTION_OF, KEY, MEAN, LAG = 0, 4, 8, 11, 12, 15, 16, 17
BEFORE = 5
"""A lagged pair: four vertices, their weights, the normal, the load [N], the friction [N] (3) that explicit methods
hold through a step (held_friction_kernels.py) or in implicit stages its direction (friction_slopes_kernels.py), a
number that grows along the list, the mean load of the latest step.
BEFORE: that number, the friction and the load of the pairs of the step before."""
