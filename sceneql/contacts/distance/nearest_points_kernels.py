# mypy: ignore-errors
"""Where two cores are nearest, by kind of feature: over a face, at two edges, at a vertex and an edge.

Each writes the two points, ON_A and ON_B in the working memory, and tells how far apart they are.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.axes_kernels import over_corners
from sceneql.contacts.distance.core_kernels import (
    CORNER,
    CORNER_OF_A,
    CORNER_OF_B,
    EDGES,
    FACE_OF_A,
    FACE_OF_B,
    FAR,
    NORMAL,
    ON_A,
    ON_B,
    at3,
    cross,
    dot,
    edges_at,
    loop_at,
    normals_at,
    put3,
)
from sceneql.contacts.distance.overlay_kernels import overlay
from sceneql.system.signatures_kernels import A, F, I, N


@lean(types.boolean(I, N, N, N, N, N, A, F), inner=True)
def over_face(ints, i, core, face, other, vertex, room, tiny):
    """Whether a vertex of another core is over or under a face."""
    nx, ny, nz = at3(room, normals_at(ints, i, core) + 3 * face)
    x, y, z = at3(room, other + 3 * vertex)
    loop, sides = loop_at(ints, i, face)
    px, py, pz = at3(room, core + 3 * ints[loop + sides - 1])
    for k in range(sides):
        qx, qy, qz = at3(room, core + 3 * ints[loop + k])
        sx, sy, sz = cross(qx - px, qy - py, qz - pz, nx, ny, nz)
        out = dot(sx, sy, sz, x - qx, y - qy, z - qz)
        if out > 0.0 and out * out > tiny * tiny * dot(sx, sy, sz, sx, sy, sz):
            return False
        px, py, pz = qx, qy, qz
    return True


@lean(F(I, N, N, N, N, A, N, N, N, N, F, F, F, F, F), inner=True)
def at_face(ints, ia, core_a, ib, core_b, room, work, kind, i, j, apart, x, y, z, tiny):
    """The lowest points over a face, along its normal (x, y, z) from a to b; infinity where nothing is over it.

    ``i``, ``j``: the face and the vertex that is nearest to its plane, at a distance ``apart`` [m].
    """
    if kind == FACE_OF_A and over_face(ints, ia, core_a, i, core_b, j, room, tiny):
        found, of_b, height = core_b + 3 * j, 1, apart
    elif kind == FACE_OF_B and over_face(ints, ib, core_b, j, core_a, i, room, tiny):
        found, of_b, height = core_a + 3 * i, 0, apart
    else:
        count, work, of_b = overlay(ints, ia, core_a, ib, core_b, room, work, x, y, z, tiny)[:3]
        found, height = 0, math.inf
        for k in range(count):
            at = work + CORNER * k
            if abs(room[at + 3]) < abs(height):
                found, height = at, room[at + 3]
        if height == math.inf:
            return height
    px, py, pz = at3(room, found)
    sign = -height if of_b == 1 else height
    put3(room, ON_B if of_b == 1 else ON_A, px, py, pz)
    put3(room, ON_A if of_b == 1 else ON_B, px + sign * x, py + sign * y, pz + sign * z)
    return abs(height)


@lean(types.void(I, N, N, A, F, N), inner=True)
def on_edge(ints, e, core, room, s, to):
    """Writes a point of an edge."""
    px, py, pz = at3(room, core + 3 * ints[e])
    qx, qy, qz = at3(room, core + 3 * ints[e + 1])
    put3(room, to, px + s * (qx - px), py + s * (qy - py), pz + s * (qz - pz))


@lean(types.UniTuple(F, 3)(I, N, N, A), inner=True)
def edge_vector(ints, e, core, room):
    """From the first to the second vertex of an edge."""
    px, py, pz = at3(room, core + 3 * ints[e])
    qx, qy, qz = at3(room, core + 3 * ints[e + 1])
    return qx - px, qy - py, qz - pz


@lean_inlined
def between(room):
    """From the point of a to that of b."""
    return room[ON_B] - room[ON_A], room[ON_B + 1] - room[ON_A + 1], room[ON_B + 2] - room[ON_A + 2]


@lean(F(I, N, N, N, N, A), inner=True)
def at_edges(ints, e, core_a, g, core_b, room):
    """The nearest points of the lines of two edges, where these are within the edges; else ends of the edges."""
    ux, uy, uz = edge_vector(ints, e, core_a, room)
    vx, vy, vz = edge_vector(ints, g, core_b, room)
    on_edge(ints, e, core_a, room, 0.0, ON_A)
    on_edge(ints, g, core_b, room, 0.0, ON_B)
    dx, dy, dz = between(room)
    mx, my, mz = cross(ux, uy, uz, vx, vy, vz)
    scale = 1.0 / dot(mx, my, mz, mx, my, mz)
    s = dot(mx, my, mz, *cross(dx, dy, dz, vx, vy, vz)) * scale
    t = dot(mx, my, mz, *cross(dx, dy, dz, ux, uy, uz)) * scale
    on_edge(ints, e, core_a, room, min(1.0, max(0.0, s)), ON_A)
    on_edge(ints, g, core_b, room, min(1.0, max(0.0, t)), ON_B)
    dx, dy, dz = between(room)
    return math.sqrt(dot(dx, dy, dz, dx, dy, dz))


@lean(types.UniTuple(F, 3)(F, F, F), inner=True)
def any_across(ux, uy, uz):
    """A unit vector across another, which may be 0."""
    if ux == 0.0 and uy == 0.0 and uz == 0.0:
        return 0.0, 0.0, -1.0
    upright = abs(uz) > max(abs(ux), abs(uy))
    px, py, pz = cross(ux, uy, uz, 0.0, 1.0 * upright, 1.0 * (not upright))
    px, py, pz = cross(ux, uy, uz, px, py, pz)
    size = math.sqrt(dot(px, py, pz, px, py, pz))
    return px / size, py / size, pz / size


@lean(types.Tuple((N, N, N, F))(I, N, N, N, N, A, F, F), inner=True)
def at_corner(ints, ia, core_a, ib, core_b, room, within, least):
    """The nearest vertex and edge of two cores, if nearer than ``within``: their kind (else FAR), features, distance.

    Writes the unit vector from a to b there in the place of the normal, if they are at one place any across the edge.
    """
    d, vertex_a, edge_b, s = over_corners(ints, ia, core_a, ib, core_b, room, within, least)
    d, vertex_b, edge_a, t = over_corners(ints, ib, core_b, ia, core_a, room, d, least)
    if vertex_b >= 0:
        kind, i, j, e, core, s = CORNER_OF_B, edge_a, vertex_b, edges_at(ints, ia) + 4 * edge_a, core_a, t
        on_edge(ints, e, core_a, room, s, ON_A)
        put3(room, ON_B, *at3(room, core_b + 3 * vertex_b))
    elif vertex_a >= 0:
        kind, i, j, e, core = CORNER_OF_A, vertex_a, edge_b, edges_at(ints, ib) + 4 * edge_b, core_b
        put3(room, ON_A, *at3(room, core_a + 3 * vertex_a))
        on_edge(ints, e, core_b, room, s, ON_B)
    else:
        return FAR, 0, 0, d
    mx, my, mz = between(room)
    ux, uy, uz = edge_vector(ints, e, core, room)
    if d > 0.0 and 0.0 < s < 1.0:
        # Exactly across the edge: of points almost at one place the difference is rounding.
        part = dot(mx, my, mz, ux, uy, uz) / dot(ux, uy, uz, ux, uy, uz)
        mx, my, mz = mx - part * ux, my - part * uy, mz - part * uz
    size = math.sqrt(dot(mx, my, mz, mx, my, mz))
    if size > 0.0:
        put3(room, NORMAL, mx / size, my / size, mz / size)
    else:
        if ux == 0.0 and uy == 0.0 and uz == 0.0:
            other, at = (ia, core_a) if core == core_b else (ib, core_b)
            if ints[other + EDGES] > 0:
                ux, uy, uz = edge_vector(ints, edges_at(ints, other), at, room)
        put3(room, NORMAL, *any_across(ux, uy, uz))
    return kind, i, j, d
