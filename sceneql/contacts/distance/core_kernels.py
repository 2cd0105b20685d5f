# mypy: ignore-errors
"""Convex shapes in the working memory: their vertices and normals, turned to the world's axes.

The numbers of a shape: those of `convex.Convex`. In the working memory a core is its vertices (v, 3), relative to the
center of body a, the normals of its faces (f, 3), and how far each vertex is behind the plane that bounds the core in
the direction of least overlap (v).
"""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A, F, I, N

KIND, FLOATS, INTS = range(3)
"""Integers of a shape."""
RADIUS, REACH, POINTS = range(3)
"""Numbers of a shape; the vertices or the plane's normal begin at POINTS."""
VERTICES, FACES, EDGES, LOOPS, STARTS = range(5)
"""Integers of a core; where the loops of its faces begin stands from STARTS on."""
PLACE = 7
"""Numbers of a place: center and quaternion."""

GAP, NORMAL, ON_A, ON_B, ADVANCES, HEAD = 0, 1, 4, 7, 10, 11
"""What was found, at the beginning of the working memory: the gap [m], the unit normal from b to a, and the witnesses
[m], relative to the center of body a; in how many advances a first touch was. The cores follow."""
MOVED = 2 * PLACE
"""Numbers at the end of the working memory, for places of bodies that move."""
CHOSEN = 48
"""Numbers for the corners of a manifold that are chosen of many."""
ROOM = HEAD + MOVED + CHOSEN
CORNER = 6
"""Numbers of a corner: its place (3), the height of the other core from it, the lines of the polygon before and after:
sides of the core whose face is cut, then from overlay_kernels.SIDES on those of the face that cuts."""
FAR, FACE_OF_A, FACE_OF_B, TWO_EDGES, CORNER_OF_A, CORNER_OF_B = range(6)
"""What is nearest: not looked for; a face, two edges, a vertex of one and an edge of the other."""
FOUND = types.Tuple((N, N, N))
"""Of what is nearest: its kind, and the features of a and b (faces, edges, vertices by the kind)."""

EPSILON = 2.220446049250313e-16
ROUNDING = 4.0 * EPSILON
"""Error of a scalar product, in parts of its numbers."""


@lean_inlined
def dot(a, b, c, x, y, z):
    """Scalar product."""
    return a * x + b * y + c * z


@lean_inlined
def cross(a, b, c, x, y, z):
    """Vector product."""
    return b * z - c * y, c * x - a * z, a * y - b * x


@lean_inlined
def at3(array, k):
    """Three numbers."""
    return array[k], array[k + 1], array[k + 2]


@lean_inlined
def put3(array, k, x, y, z):
    """Writes three numbers."""
    array[k], array[k + 1], array[k + 2] = x, y, z


@lean_inlined
def loop_at(ints, i, face):
    """Where the loop of a face begins, and its length."""
    first = ints[i + STARTS + face]
    return i + STARTS + ints[i + FACES] + 1 + first, ints[i + STARTS + face + 1] - first


@lean_inlined
def edges_at(ints, i):
    """Where the edges begin."""
    return i + STARTS + ints[i + FACES] + 1 + ints[i + LOOPS]


@lean_inlined
def normals_at(ints, i, core):
    """Where the normals of a core begin in the working memory."""
    return core + 3 * ints[i + VERTICES]


@lean_inlined
def behind_at(ints, i, core):
    """Where it stands how far the vertices of a core are behind its bounding plane."""
    return core + 3 * (ints[i + VERTICES] + ints[i + FACES])


@lean_inlined
def end_of(ints, i, core):
    """Where a core ends in the working memory."""
    return core + 4 * ints[i + VERTICES] + 3 * ints[i + FACES]


@lean(types.void(A, I, N, A, N, F, F, F, A, N), inner=True)
def load(floats, ints, shape, places, at, ox, oy, oz, room, core):
    """Puts a core into the working memory, its body's center at (ox, oy, oz)."""
    f, i = ints[shape + FLOATS] + POINTS, ints[shape + INTS]
    ax, ay, az = to_world(places, at + 3, 1.0, 0.0, 0.0)
    bx, by, bz = to_world(places, at + 3, 0.0, 1.0, 0.0)
    cx, cy, cz = to_world(places, at + 3, 0.0, 0.0, 1.0)
    vertices = ints[i + VERTICES]
    for k in range(vertices + ints[i + FACES]):
        x, y, z = at3(floats, f + 3 * k)
        to = core + 3 * k
        room[to] = ax * x + bx * y + cx * z
        room[to + 1] = ay * x + by * y + cy * z
        room[to + 2] = az * x + bz * y + cz * z
        if k < vertices:
            room[to] += ox
            room[to + 1] += oy
            room[to + 2] += oz


@lean(types.Tuple((F, N))(A, N, N, F, F, F), inner=True)
def farthest(room, core, count, x, y, z):
    """The largest scalar product of a direction and a vertex, and the first vertex that has it."""
    best, found = -math.inf, 0
    for k in range(count):
        d = room[core + 3 * k] * x + room[core + 3 * k + 1] * y + room[core + 3 * k + 2] * z
        if d > best:
            best, found = d, k
    return best, found


@lean_inlined
def relative(places, at_a, at_b):
    """From the center of body a to that of body b."""
    return places[at_b] - places[at_a], places[at_b + 1] - places[at_a + 1], places[at_b + 2] - places[at_a + 2]
