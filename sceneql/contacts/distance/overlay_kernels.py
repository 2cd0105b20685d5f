# mypy: ignore-errors
"""What of two cores faces each other along a direction: their features there, projected along it and intersected.

Over the intersection the distance along the direction is an affine function where both features are flat, so that it is
least at a corner: a vertex of one over a face of the other, or two edges that cross.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.core_kernels import (
    CORNER,
    EDGES,
    FACES,
    VERTICES,
    at3,
    cross,
    dot,
    edges_at,
    farthest,
    loop_at,
    normals_at,
)
from sceneql.system.signatures_kernels import A, F, I, N

ALIGNED = 0.9
"""Least cosine between a direction and the normal of a face that faces it."""
LEVEL = 0.43
"""Greatest cosine between a direction and an edge that faces it: the sine of that angle."""
SIDES = 1 << 20
CROSSED = 1e-6
"""Sine of the angle of two edges, seen along the normal, up to which they touch along a line."""
NONE = -1


@lean(N(I, N, N, A, F, F, F), inner=True)
def face_along(ints, i, core, room, x, y, z):
    """The face that faces a unit vector best; NONE where none does."""
    best, found = ALIGNED, NONE
    at = normals_at(ints, i, core)
    for k in range(ints[i + FACES]):
        d = dot(*at3(room, at + 3 * k), x, y, z)
        if d > best:
            best, found = d, k
    return found


@lean(types.Tuple((N, N))(I, N, N, A, F, F, F), inner=True)
def edge_along(ints, i, core, room, x, y, z):
    """The vertex that is farthest along a unit vector, and of the edges there the one most across; else NONE."""
    vertex = farthest(room, core, ints[i + VERTICES], x, y, z)[1]
    best, found = LEVEL * LEVEL, NONE
    at = edges_at(ints, i)
    for k in range(ints[i + EDGES]):
        a, b = ints[at + 4 * k], ints[at + 4 * k + 1]
        if a != b and (a == vertex or b == vertex):
            ax, ay, az = at3(room, core + 3 * a)
            bx, by, bz = at3(room, core + 3 * b)
            ux, uy, uz = bx - ax, by - ay, bz - az
            d = dot(ux, uy, uz, x, y, z) ** 2 / dot(ux, uy, uz, ux, uy, uz)
            if d < best:
                best, found = d, k
    return vertex, found


@lean_inlined
def put(room, at, x, y, z, before, after):
    """Writes a corner."""
    room[at], room[at + 1], room[at + 2] = x, y, z
    room[at + 4], room[at + 5] = before, after


@lean_inlined
def copy_corner(room, at, to):
    """Copies a corner."""
    for c in range(CORNER):
        room[to + c] = room[at + c]


@lean(N(A, N, N, N, F, F, F, F, F), inner=True)
def cut(room, at, count, to, x, y, z, limit, side):
    """Cuts a polygon, segment or point by the half space (x, y, z).p <= limit; its number of corners (Sutherland &
    Hodgman 1974)."""
    made = 0
    for k in range(count):
        p, q = at + CORNER * k, at + CORNER * ((k + 1) % count)
        d, e = dot(*at3(room, p), x, y, z) - limit, dot(*at3(room, q), x, y, z) - limit
        if d <= 0.0:
            copy_corner(room, p, to + CORNER * made)
            made += 1
        if (d <= 0.0) != (e <= 0.0) and (count > 2 or k == 0) and count > 1:
            s = d / (d - e)
            px, py, pz = at3(room, p)
            qx, qy, qz = at3(room, q)
            line = room[p + 5]
            before, after = (line, side) if d <= 0.0 else (side, line)
            put(room, to + CORNER * made, px + s * (qx - px), py + s * (qy - py), pz + s * (qz - pz), before, after)
            made += 1
    return made


@lean(types.Tuple((N, N, N, N, N))(I, N, N, N, N, A, N, F, F, F, F), inner=True)
def overlay(ints, ia, core_a, ib, core_b, room, work, x, y, z, tiny):
    """The corners of what faces each other along the unit vector (x, y, z) from a to b, with their heights.

    Their number and where they stand; whether they are points of a (0) or of b (1), the face of the other, and the
    feature (face; or -2 - edge, or -2 - edges - vertex) that was cut. No corners where neither has a face there.
    """
    face_a = face_along(ints, ia, core_a, room, x, y, z)
    face_b = face_along(ints, ib, core_b, room, -x, -y, -z)
    if face_a == NONE and face_b == NONE:
        return 0, work, 0, NONE, NONE
    na, nb = normals_at(ints, ia, core_a) + 3 * face_a, normals_at(ints, ib, core_b) + 3 * face_b
    along_a = dot(*at3(room, na), x, y, z) if face_a != NONE else -1.0
    along_b = -dot(*at3(room, nb), x, y, z) if face_b != NONE else -1.0
    of_b = 1 if along_a >= along_b - 1e-12 else 0
    if of_b == 1:
        i, core, face, other, points, feature, sign, n = ia, core_a, face_a, ib, core_b, face_b, 1.0, na
    else:
        i, core, face, other, points, feature, sign, n = ib, core_b, face_b, ia, core_a, face_a, -1.0, nb
    count = 0
    if feature != NONE:
        loop, count = loop_at(ints, other, feature)
        for k in range(count):
            px, py, pz = at3(room, points + 3 * ints[loop + k])
            put(room, work + CORNER * k, px, py, pz, (k + count - 1) % count, k)
    else:
        vertex, edge = edge_along(ints, other, points, room, -sign * x, -sign * y, -sign * z)
        feature = -2 - (edge if edge != NONE else ints[other + EDGES] + vertex)
        ends = edges_at(ints, other) + 4 * edge
        count = 1 if edge == NONE else 2
        for k in range(count):
            px, py, pz = at3(room, points + 3 * (vertex if edge == NONE else ints[ends + k]))
            put(room, work + CORNER * k, px, py, pz, NONE - k, NONE - k)
        if count == 2:
            room[work + 4], room[work + 5] = NONE, 0.0
    loop, sides = loop_at(ints, i, face)
    spare = work + CORNER * (count + sides)
    for k in range(sides):
        px, py, pz = at3(room, core + 3 * ints[loop + k])
        qx, qy, qz = at3(room, core + 3 * ints[loop + (k + 1) % sides])
        sx, sy, sz = cross(qx - px, qy - py, qz - pz, sign * x, sign * y, sign * z)
        size = math.sqrt(sx * sx + sy * sy + sz * sz)
        limit = dot(sx, sy, sz, px, py, pz) + tiny * size
        count = cut(room, work, count, spare, sx, sy, sz, limit, SIDES + k)
        work, spare = spare, work
    nx, ny, nz = at3(room, n)
    px, py, pz = at3(room, core + 3 * ints[loop])
    scale = 1.0 / (sign * dot(nx, ny, nz, x, y, z))
    for k in range(count):
        at = work + CORNER * k
        room[at + 3] = scale * dot(nx, ny, nz, room[at] - px, room[at + 1] - py, room[at + 2] - pz)
    return count, work, of_b, face, feature


@lean_inlined
def ends_along(room, core, ints, e, ux, uy, uz):
    """How far along a vector the ends of an edge are: first the nearer, then the farther."""
    p = dot(*at3(room, core + 3 * ints[e]), ux, uy, uz)
    q = dot(*at3(room, core + 3 * ints[e + 1]), ux, uy, uz)
    return p, q


@lean(types.Tuple((N, N, N))(I, N, N, N, N, A, N, F, F, F), inner=True)
def two_lines(ints, ia, core_a, ib, core_b, room, work, x, y, z):
    """The two ends, points of b, of what two edges share that are parallel as seen along (x, y, z), from a to b.

    Their number, which is 0 where there are none, and the edges.
    """
    i, j = edge_along(ints, ia, core_a, room, x, y, z)[1], edge_along(ints, ib, core_b, room, -x, -y, -z)[1]
    if i < 0 or j < 0:
        return 0, i, j
    e, g = edges_at(ints, ia) + 4 * i, edges_at(ints, ib) + 4 * j
    px, py, pz = at3(room, core_a + 3 * ints[e])
    ux, uy, uz = at3(room, core_a + 3 * ints[e + 1])
    rx, ry, rz = at3(room, core_b + 3 * ints[g])
    vx, vy, vz = at3(room, core_b + 3 * ints[g + 1])
    ux, uy, uz, vx, vy, vz = ux - px, uy - py, uz - pz, vx - rx, vy - ry, vz - rz
    square = dot(ux, uy, uz, ux, uy, uz) * dot(vx, vy, vz, vx, vy, vz)
    if abs(dot(*cross(ux, uy, uz, vx, vy, vz), x, y, z)) > CROSSED * math.sqrt(square):
        return 0, i, j
    # Along the edge of a, across the normal.
    part = dot(ux, uy, uz, x, y, z)
    wx, wy, wz = ux - part * x, uy - part * y, uz - part * z
    a0, a1 = ends_along(room, core_a, ints, e, wx, wy, wz)
    b0, b1 = ends_along(room, core_b, ints, g, wx, wy, wz)
    low, high = max(min(a0, a1), min(b0, b1)), min(max(a0, a1), max(b0, b1))
    if high < low:
        return 0, i, j
    for k in range(2):
        at = low if k == 0 else high
        s, t = (at - a0) / (a1 - a0), (at - b0) / (b1 - b0)
        bx, by, bz = rx + t * vx, ry + t * vy, rz + t * vz
        height = dot(bx - px - s * ux, by - py - s * uy, bz - pz - s * uz, x, y, z)
        # Which end of which edge it is.
        end = (0 if at == a0 else 1) if at == a0 or at == a1 else (2 if at == b0 else 3)
        put(room, work + CORNER * k, bx, by, bz, 0.0, 1.0 * end)
        room[work + CORNER * k + 3] = height
    return 2, i, j
