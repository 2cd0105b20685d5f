# mypy: ignore-errors
"""The gap of two convex shapes: their signed distance, where they are nearest, and the normal there."""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import CORE, HALF_SPACE
from sceneql.contacts.distance.core_kernels import (
    CORNER_OF_A,
    CORNER_OF_B,
    FAR,
    FLOATS,
    FOUND,
    GAP,
    HEAD,
    INTS,
    KIND,
    NORMAL,
    ON_A,
    ON_B,
    POINTS,
    RADIUS,
    VERTICES,
    at3,
    dot,
    farthest,
    load,
    put3,
    relative,
)
from sceneql.system.signatures_kernels import A, F, I, N

closest = lazy("sceneql.contacts.distance.separation_kernels:closest", FOUND(A, I, N, N, A, N, N, F, A))


@lean(FOUND(A, I, N, N, A, N, N, A), inner=True)
def over_plane(floats, ints, a, b, places, at_a, at_b, room):
    """As `separation_kernels.closest`, of a core a and a half space b."""
    fa, ia, fb = ints[a + FLOATS], ints[a + INTS], ints[b + FLOATS]
    ox, oy, oz = relative(places, at_a, at_b)
    x, y, z = to_world(places, at_b + 3, *at3(floats, fb + POINTS))
    load(floats, ints, a, places, at_a, 0.0, 0.0, 0.0, room, HEAD)
    far, vertex = farthest(room, HEAD, ints[ia + VERTICES], -x, -y, -z)
    height = -far - (dot(x, y, z, ox, oy, oz) + floats[fb + POINTS + 3])
    px, py, pz = at3(room, HEAD + 3 * vertex)
    room[GAP] = height - floats[fa + RADIUS]
    put3(room, NORMAL, x, y, z)
    put3(room, ON_A, px, py, pz)
    put3(room, ON_B, px - height * x, py - height * y, pz - height * z)
    return CORNER_OF_A, vertex, 0


@lean(FOUND(A, I, N, N, A, N, N, F, A), inner=True)
def nearest(floats, ints, a, b, places, at_a, at_b, reach, room):
    """As `separation_kernels.closest`, of any two shapes. Two half spaces are never near each other."""
    if ints[a + KIND] == CORE and ints[b + KIND] == CORE:
        return closest(floats, ints, a, b, places, at_a, at_b, reach, room)
    if ints[a + KIND] == ints[b + KIND]:
        room[GAP] = math.inf
        return FAR, 0, 0
    if ints[b + KIND] == HALF_SPACE:
        return over_plane(floats, ints, a, b, places, at_a, at_b, room)
    vertex = over_plane(floats, ints, b, a, places, at_b, at_a, room)[1]
    ox, oy, oz = relative(places, at_a, at_b)
    for c in range(3):
        room[NORMAL + c] = -room[NORMAL + c]
        room[ON_A + c], room[ON_B + c] = room[ON_B + c], room[ON_A + c]
    for at in (ON_A, ON_B):
        put3(room, at, room[at] + ox, room[at + 1] + oy, room[at + 2] + oz)
    return CORNER_OF_B, 0, vertex


@lean(types.UniTuple(F, 10)(A, I, N, N, A, N, N, A))
def gap(floats, ints, a, b, places, at_a, at_b, room):
    """The signed distance [m] of two shapes, the unit normal from b to a, and the points of a and b that are nearest.

    ``ints[a:]``, ``ints[b:]``: the shapes; ``places[at_a:]``, ``places[at_b:]``: where their bodies are; ``room``:
    working memory (convex.room_length). Where they overlap the distance is minus the shortest way that separates them.
    Two half spaces have no gap: infinity.
    """
    kind = nearest(floats, ints, a, b, places, at_a, at_b, math.inf, room)[0]
    if kind == FAR:
        return math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ra = floats[ints[a + FLOATS] + RADIUS]
    rb = floats[ints[b + FLOATS] + RADIUS]
    nx, ny, nz = at3(room, NORMAL)
    x, y, z = at3(places, at_a)
    ax, ay, az = at3(room, ON_A)
    bx, by, bz = at3(room, ON_B)
    ax, ay, az = x + (ax - ra * nx), y + (ay - ra * ny), z + (az - ra * nz)
    bx, by, bz = x + (bx + rb * nx), y + (by + rb * ny), z + (bz + rb * nz)
    return room[GAP], nx, ny, nz, ax, ay, az, bx, by, bz
