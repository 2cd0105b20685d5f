"""The integers by which skins in flows touch one another, and themselves: indices by name."""

VERTICES, FACES, CORNERS, SKINS, NUMBERS, FRICTION, WEIGHTS, REST, ROOM, BEST, HOLDS, CLEAR, HEAD = range(13)
"""Numbers of vertices and faces of all skins; corners of a face; number of skins; offsets in the floats of NUMBERS, of
the coefficient of friction, for each vertex of its share of area and its skin's stiffness, of the places at the start
(3), of room for a grid of CELLS cells for each vertex, of the BEST of each skin, of the HOLDS, and of what is CLEAR.
From HEAD on for each vertex its VERTEX integers; the corners of each face; where in the list that follows the faces
whose first corner is each vertex begin, and, after the last, its end; that list."""

POSITION, FORCE, SKIN, VERTEX = range(4)
"""Offsets in y of the place and in the floats of the force of a vertex; number of its skin."""

GAP, SIDE, STEEP, GONE, PERIODS = range(5)
"""NUMBERS: the gap [m]; the longest side of a face in the state that was looked at last [m]; touch_layout.STEEP; how
far vertices have at most gone so far, besides all together [m]; along each axis how long the flow is where it is
periodic, else 0 [m]."""

LOW, SCALE, ACROSS, STARTS = 0, 3, 4, 7
CELLS = 4
"""ROOM: low corner, cells by length [1/m], cells along each axis; from STARTS on where each cell's vertices begin in
the list that follows after CELLS for each vertex and one more."""

DISTANCE, NORMAL, FACE, SHARES, FOUND = 0, 1, 4, 5, 8
"""BEST: for each skin the least distance from it, the normal towards the vertex (3), its face, the weights of its
corners (3)."""

APART = 2.0
"""Gaps between places of one skin at the start above which they touch: what is nearer stretches and bends."""

ON, PARTS, HOLD = 0, 1, 4
"""HOLDS: for each vertex and skin the face at which friction holds the vertex, -1 where none does, and the weights of
its corners (3) at that place, which may lie beyond its sides."""

PLACES, BOUND = 0, 3
"""CLEAR: for each vertex its place when GONE grew last (3), and less than how far off nothing is as long as GONE does
not grow, plus twice GONE [m]."""
BOUNDS = 4
"""Floats of CLEAR for each vertex."""
