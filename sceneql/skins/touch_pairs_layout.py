"""The integers by which skins in flows touch one another, and themselves: indices by name."""

VERTICES, FACES, CORNERS, SKINS, NUMBERS, FRICTION, WEIGHTS, REST, ROOM, BEST, HEAD = range(11)
"""Numbers of vertices and faces of all skins; corners of a face; number of skins; offsets in the floats of NUMBERS, of
the coefficient of friction, for each vertex of its share of area and its skin's stiffness, of the places at the start
(3), of room for a grid of CELLS cells for each vertex, and of the BEST of each skin. From HEAD on for each vertex its
VERTEX integers; the corners of each face; where in the list that follows the faces at each vertex begin, and, after the
last, its end; that list."""

POSITION, FORCE, SKIN, VERTEX = range(4)
"""Offsets in y of the place and in the floats of the force of a vertex; number of its skin."""

GAP, IMPEDANCE, SIDE, STEEP = range(4)
"""NUMBERS: the gap [m]; the most that friction grows by area with the speed of slip [Pa s/m]; the longest side of a
face in the state that was looked at last [m]; touch_layout.STEEP."""

LOW, SCALE, ACROSS, STARTS = 0, 3, 4, 7
CELLS = 4
"""ROOM: low corner, cells by length [1/m], cells along each axis; from STARTS on where each cell's vertices begin in
the list that follows after CELLS for each vertex and one more."""

DISTANCE, NORMAL, FACE, SHARES, FOUND = 0, 1, 4, 5, 8
"""BEST: for each skin the least distance from it, the normal towards the vertex (3), its face, the weights of its
corners (3)."""

APART = 2.0
"""Gaps between places of one skin at the start above which they touch: what is nearer stretches and bends."""
