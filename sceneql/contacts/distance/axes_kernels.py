# mypy: ignore-errors
"""Directions that may separate two cores: normals of their faces, and of pairs of their edges.

The overlap of two polyhedra is least along one of them, and where they are apart their distance is along one or between
a vertex and an edge. What is measured along a direction is always by all vertices, so that it is never too large.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.core_kernels import (
    EDGES,
    FACES,
    VERTICES,
    at3,
    behind_at,
    cross,
    dot,
    edges_at,
    farthest,
    loop_at,
    normals_at,
)
from sceneql.system.signatures_kernels import A, F, I, N

PARALLEL = 1e-24
"""Square of the sine of the angle of two edges up to which they have no common normal of their own."""
OUTSIDE = 1e-9
"""Cosine to the sum of the normals at an edge up to which a direction may be between them, for rounding."""
NONE = -1


@lean(F(I, N, N, N, N, A, F, F, F), inner=True)
def along(ints, ia, core_a, ib, core_b, room, x, y, z):
    """The distance [m] of two cores along a unit vector from a to b; negative where they overlap."""
    far_a = farthest(room, core_a, ints[ia + VERTICES], x, y, z)[0]
    far_b = farthest(room, core_b, ints[ib + VERTICES], -x, -y, -z)[0]
    return -far_b - far_a


@lean(types.Tuple((F, N, N))(I, N, N, N, N, A, F, F), inner=True)
def over_faces(ints, i, core, j, other, room, best, tiny):
    """The largest distance along the normal of a face of a core, where it is above ``best`` by more than ``tiny``.

    The distance, the face (else NONE) and the vertex of the other that is nearest to its plane.
    """
    found, at, vertex = NONE, 0, 0
    normals = normals_at(ints, i, core)
    for face in range(ints[i + FACES]):
        x, y, z = at3(room, normals + 3 * face)
        loop = loop_at(ints, i, face)[0]
        height = dot(*at3(room, core + 3 * ints[loop]), x, y, z)
        # The vertex nearest to the last plane tells of most others that they are not better.
        low = dot(*at3(room, other + 3 * vertex), x, y, z) - height
        k = 0
        while k < ints[j + VERTICES] and low > best + tiny:
            d = dot(*at3(room, other + 3 * k), x, y, z) - height
            if d < low:
                low, vertex = d, k
            k += 1
        if low > best + tiny:
            best, found, at = low, face, vertex
    return best, found, at


@lean_inlined
def side_of(ints, edge, room, normals):
    """The sum of the normals of the faces at an edge; 0 where it has none."""
    f, g = ints[edge + 2], ints[edge + 3]
    if f < 0:
        return 0.0, 0.0, 0.0
    ax, ay, az = at3(room, normals + 3 * f)
    bx, by, bz = at3(room, normals + 3 * g)
    return ax + bx, ay + by, az + bz


@lean_inlined
def turns(ints, edge, room, normals, x, y, z):
    """Whether the plane across a vector goes through the arc between the normals of the faces at an edge."""
    f, g = ints[edge + 2], ints[edge + 3]
    return f < 0 or dot(*at3(room, normals + 3 * f), x, y, z) * dot(*at3(room, normals + 3 * g), x, y, z) <= 0.0


@lean(types.Tuple((F, N, N, F, F, F))(I, N, N, N, N, A, F, F, F), inner=True)
def over_edges(ints, ia, core_a, ib, core_b, room, best, tiny, most):
    """The largest distance along the common normal of two edges, where it is above ``best`` by more than ``tiny``.

    The distance, the edges (else NONE) and the unit normal from a to b. Left out are edges whose vertices are farther
    behind the bounding planes than ``most``.
    """
    na, nb = normals_at(ints, ia, core_a), normals_at(ints, ib, core_b)
    da, db = behind_at(ints, ia, core_a), behind_at(ints, ib, core_b)
    ea, eb = edges_at(ints, ia), edges_at(ints, ib)
    edge_a, edge_b, bx, by, bz = NONE, NONE, 0.0, 0.0, 0.0
    # Whether the edges found bound the cores along their normal, and not others parallel to them.
    touch = True
    for i in range(ints[ia + EDGES]):
        e = ea + 4 * i
        p, q = ints[e], ints[e + 1]
        behind = min(room[da + p], room[da + q])
        if behind > most:
            continue
        px, py, pz = at3(room, core_a + 3 * p)
        qx, qy, qz = at3(room, core_a + 3 * q)
        ux, uy, uz = qx - px, qy - py, qz - pz
        sx, sy, sz = side_of(ints, e, room, na)
        square = dot(ux, uy, uz, ux, uy, uz)
        for j in range(ints[ib + EDGES]):
            g = eb + 4 * j
            r, s = ints[g], ints[g + 1]
            if behind + min(room[db + r], room[db + s]) > most or not turns(ints, g, room, nb, ux, uy, uz):
                continue
            rx, ry, rz = at3(room, core_b + 3 * r)
            vx, vy, vz = at3(room, core_b + 3 * s)
            vx, vy, vz = vx - rx, vy - ry, vz - rz
            if not turns(ints, e, room, na, vx, vy, vz):
                continue
            mx, my, mz = cross(ux, uy, uz, vx, vy, vz)
            size = dot(mx, my, mz, mx, my, mz)
            if size <= PARALLEL * square * dot(vx, vy, vz, vx, vy, vz):
                continue
            size = 1.0 / math.sqrt(size)
            mx, my, mz = mx * size, my * size, mz * size
            tx, ty, tz = side_of(ints, g, room, nb)
            toward, away = dot(mx, my, mz, sx, sy, sz), dot(mx, my, mz, tx, ty, tz)
            d = dot(mx, my, mz, rx - px, ry - py, rz - pz)
            if toward < away or (toward == away and d < 0.0):
                mx, my, mz, d, toward, away = -mx, -my, -mz, -d, -toward, -away
            if toward < -OUTSIDE or away > OUTSIDE or d <= best + (tiny if touch else -tiny):
                continue
            low = along(ints, ia, core_a, ib, core_b, room, mx, my, mz)
            bounding = d <= low + 4.0 * tiny
            if low > best + tiny or (low > best - tiny and bounding and not touch and edge_a != NONE):
                best, edge_a, edge_b, bx, by, bz, touch = low, i, j, mx, my, mz, bounding
    return best, edge_a, edge_b, bx, by, bz


@lean(types.Tuple((F, N, N, F))(I, N, N, N, N, A, F, F), inner=True)
def over_corners(ints, i, core, j, other, room, nearest, least):
    """The nearest vertex of a core to an edge of another, where it is nearer than ``nearest`` [m].

    The distance, the vertex (else NONE), the edge, and where along it. ``least`` [m]: a distance along the direction
    of the bounding planes, so that what is farther behind them cannot be nearer.
    """
    di, dj, edges = behind_at(ints, i, core), behind_at(ints, j, other), edges_at(ints, j)
    vertex, edge, where, closest = NONE, NONE, 0.0, nearest * nearest
    for k in range(ints[i + VERTICES]):
        if least + room[di + k] > nearest:
            continue
        x, y, z = at3(room, core + 3 * k)
        for e in range(ints[j + EDGES]):
            p, q = ints[edges + 4 * e], ints[edges + 4 * e + 1]
            if least + room[di + k] + min(room[dj + p], room[dj + q]) > nearest:
                continue
            px, py, pz = at3(room, other + 3 * p)
            ux, uy, uz = at3(room, other + 3 * q)
            ux, uy, uz = ux - px, uy - py, uz - pz
            px, py, pz = x - px, y - py, z - pz
            square = dot(ux, uy, uz, ux, uy, uz)
            s = dot(ux, uy, uz, px, py, pz)
            if s <= 0.0 or square == 0.0:
                s = 0.0
            elif s >= square:
                s = 1.0
                px, py, pz = x - room[other + 3 * q], y - room[other + 3 * q + 1], z - room[other + 3 * q + 2]
            else:
                s /= square
                px, py, pz = px - s * ux, py - s * uy, pz - s * uz
            d = dot(px, py, pz, px, py, pz)
            if d < closest:
                closest, vertex, edge, where = d, k, e, s
                nearest = math.sqrt(d)
    return nearest, vertex, edge, where
