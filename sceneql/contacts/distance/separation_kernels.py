# mypy: ignore-errors
"""The signed distance of two cores, by their features.

First the normals of faces. Where the nearest points along the best of them lie within the face it is the distance. Else
the pairs of edges, and where the cores are apart the pairs of vertex and edge. Edges and vertices too far behind the
planes that bound the cores there are left out, so that few pairs are looked at.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.axes_kernels import along, over_edges, over_faces
from sceneql.contacts.distance.core_kernels import (
    FACE_OF_A,
    FACE_OF_B,
    FACES,
    FAR,
    FLOATS,
    FOUND,
    GAP,
    HEAD,
    INTS,
    NORMAL,
    RADIUS,
    REACH,
    ROUNDING,
    TWO_EDGES,
    VERTICES,
    at3,
    behind_at,
    dot,
    edges_at,
    end_of,
    farthest,
    load,
    normals_at,
    put3,
    relative,
)
from sceneql.contacts.distance.nearest_points_kernels import (
    at_corner,
    at_edges,
    at_face,
)
from sceneql.system.signatures_kernels import A, F, I, N


@lean(types.void(I, N, N, A, F, F, F), inner=True)
def set_behind(ints, i, core, room, x, y, z):
    """Stores how far each vertex is behind the plane that bounds a core along a unit vector; 0 along the vector 0."""
    count = ints[i + VERTICES]
    far, at = farthest(room, core, count, x, y, z)[0], behind_at(ints, i, core)
    for k in range(count):
        room[at + k] = far - dot(*at3(room, core + 3 * k), x, y, z)


@lean(F(I, N, N, N, N, A, F, F, F), inner=True)
def first_vertices(ints, ia, core_a, ib, core_b, room, x, y, z):
    """The distance of two vertices of the cores that are first along a unit vector from a to b and against it."""
    va = farthest(room, core_a, ints[ia + VERTICES], x, y, z)[1]
    vb = farthest(room, core_b, ints[ib + VERTICES], -x, -y, -z)[1]
    ux, uy, uz = at3(room, core_a + 3 * va)
    vx, vy, vz = at3(room, core_b + 3 * vb)
    return math.sqrt((vx - ux) ** 2 + (vy - uy) ** 2 + (vz - uz) ** 2)


@lean(FOUND(A, I, N, N, A, N, N, F, A), inner=True)
def closest(floats, ints, a, b, places, at_a, at_b, reach, room):
    """What is nearest of two cores: its kind, and the features of a and b (faces, edges, vertices by the kind).

    Writes the gap, the normal and the witnesses at the beginning of the working memory, without the radii but for the
    gap, and loads the cores behind them. Farther apart than ``reach`` [m] it may be FAR, with a distance that is less.
    """
    fa, ia, fb, ib = ints[a + FLOATS], ints[a + INTS], ints[b + FLOATS], ints[b + INTS]
    ox, oy, oz = relative(places, at_a, at_b)
    radii = floats[fa + RADIUS] + floats[fb + RADIUS]
    size, both = math.sqrt(dot(ox, oy, oz, ox, oy, oz)), floats[fa + REACH] + floats[fb + REACH]
    if size - both > reach:
        room[GAP] = size - both
        put3(room, NORMAL, -ox / size, -oy / size, -oz / size)
        return FAR, 0, 0
    tiny = ROUNDING * (size + both)
    core_a = HEAD
    core_b = end_of(ints, ia, core_a)
    work = end_of(ints, ib, core_b)
    load(floats, ints, a, places, at_a, 0.0, 0.0, 0.0, room, core_a)
    load(floats, ints, b, places, at_b, ox, oy, oz, room, core_b)

    # (x, y, z): unit vector from a to b along which the cores are `best` apart.
    kind, i, j, x, y, z = FAR, 0, 0, 0.0, 0.0, 0.0
    best, face, vertex = over_faces(ints, ia, core_a, ib, core_b, room, -math.inf, tiny)
    if face >= 0:
        kind, i, j = FACE_OF_A, face, vertex
        x, y, z = at3(room, normals_at(ints, ia, core_a) + 3 * face)
    best, face, vertex = over_faces(ints, ib, core_b, ia, core_a, room, best, tiny)
    if face >= 0:
        kind, i, j = FACE_OF_B, vertex, face
        x, y, z = at3(room, normals_at(ints, ib, core_b) + 3 * face)
        x, y, z = -x, -y, -z
    if kind != FAR and best - radii > reach:
        room[GAP] = best - radii
        put3(room, NORMAL, -x, -y, -z)
        return FAR, 0, 0

    # `nearest`, the distance of two points of the cores, bounds where else something can be nearer.
    nearest = math.inf
    if kind != FAR:
        nearest = at_face(ints, ia, core_a, ib, core_b, room, work, kind, i, j, best, x, y, z, tiny)
    if best < 0.0 or nearest > best + 2.0 * tiny:
        set_behind(ints, ia, core_a, room, x, y, z)
        set_behind(ints, ib, core_b, room, -x, -y, -z)
        within, least, most = nearest, best, math.inf
        if kind != FAR:
            if nearest == math.inf:
                within = first_vertices(ints, ia, core_a, ib, core_b, room, x, y, z)
            most = max(within, -best) - best + tiny
        # Edges that cross along the normal of a face do not improve on it, but are where the cores are nearest.
        floor = best - 4.0 * tiny if best > 0.0 else best
        d, ea, eb, mx, my, mz = over_edges(ints, ia, core_a, ib, core_b, room, floor, tiny, most)
        if ea >= 0:
            nearest = at_edges(ints, edges_at(ints, ia) + 4 * ea, core_a, edges_at(ints, ib) + 4 * eb, core_b, room)
            within = min(within, nearest)
            if d > best + tiny:
                kind, i, j, best, x, y, z = TWO_EDGES, ea, eb, d, mx, my, mz
        apart = best > 0.0 or ints[ia + FACES] + ints[ib + FACES] == 0
        if nearest == math.inf or (apart and nearest > best + 2.0 * tiny):
            corner, vi, vj, d = at_corner(ints, ia, core_a, ib, core_b, room, within + 2.0 * tiny, least)
            mx, my, mz = at3(room, NORMAL)
            # Points at one place have no direction, but where there are neither faces nor edges that cross.
            if corner != FAR and (d > 0.0 or kind == FAR):
                low = along(ints, ia, core_a, ib, core_b, room, mx, my, mz)
                if low > best:
                    kind, i, j, best, x, y, z = corner, vi, vj, d, mx, my, mz
    room[GAP] = best - radii
    put3(room, NORMAL, -x, -y, -z)
    return kind, i, j
