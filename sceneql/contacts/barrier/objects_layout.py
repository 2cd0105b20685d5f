"""The integers of a barrier between a skin and what stands: indices by name."""

POSITION, VELOCITY, WORK, INVERSE, NODES, EDGES, LIST, NUMBERS, FRICTION, AREAS, LAGGED, KNOWN, OBJECTS, ARMS, HEAD = (
    range(15)
)
"""Offsets of the bodies in y, and of their inverse masses in the floats; numbers of the skin's NODES and EDGES; at
LIST, in these integers: the nodes, then two places in that list for each edge, then whether each component of each node
is held; offsets in the floats of NUMBERS, of the coefficient of friction, of the AREAS of the points [m^2], of what
friction has LAGGED, and of what is KNOWN of distances; number of objects, which follow from HEAD on
(contacts/layout.py).

The points of a skin are its nodes and the middles of its edges. Of a rigid body they are NODES alone: there is no LIST,
and the system.Place of each stands in these integers from ARMS on, which else is -1."""

STIFFNESS, GAP, SLIP = range(3)
"""NUMBERS: stiffness [Pa], gap [m], speed of slip [m/s]."""

LOAD, NORMAL, HELD, MEAN, LAG = 0, 1, 4, 7, 8
LOADS = 2
"""LAGGED: channels.LAGS and channels.STAGES for which it holds; from LOADS on for each point and object its load [N]
and normal (3), and as HELD (3) the friction [N] that explicit methods hold through a step, with the mean load of the
latest (objects_friction_kernels.py), or in implicit stages the direction of friction (friction_slopes_kernels.py)."""

PLACE, DISTANCE, KNOW = 0, 3, 4
"""KNOWN: for each point and object a place, and a bound of the distance there [m]."""
