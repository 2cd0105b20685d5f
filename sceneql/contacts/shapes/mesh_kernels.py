# mypy: ignore-errors
"""A closed surface of triangles in its own coordinates, in a tree of boxes.

The sign of the distance is that of the nearest feature's normal: of a face, or for an edge or vertex the mean of its
faces weighted by their angles there, which is right for every closed surface (Baerentzen & Aanaes 2005).

Further integers: offsets of the boxes (n, 6: low, high corner) and of the triangles (m, 30) in the floats, n, and for
each box in depth-first order: the next box outside it, first triangle, number of triangles (0: it contains boxes). A
triangle: three vertices, then normals of the face, of the edges 01, 12, 20 and of the vertices.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import BEND_TYPE, CLEAR_TYPE, SURFACE_TYPE, inward, turn, unturn
from sceneql.system.signatures_kernels import A, F, I, N

BOXES, TRIANGLES, COUNT, TREE = range(4)
SKIP, FIRST, HELD, NODE = range(4)
TRIANGLE = 30
NORMALS = 9
FACE, EDGE, VERTEX = 0, 1, 4
"""Features of a triangle: the face, edges EDGE.., vertices VERTEX.."""


@lean_inlined
def outside2(floats, box, x, y, z):
    """Squared distance of a point from a box, 0 within."""
    a = max(0.0, max(floats[box] - x, x - floats[box + 3]))
    b = max(0.0, max(floats[box + 1] - y, y - floats[box + 4]))
    c = max(0.0, max(floats[box + 2] - z, z - floats[box + 5]))
    return a * a + b * b + c * c


@lean_inlined
def corner(floats, t, k, x, y, z):
    """Vector from vertex k of a triangle to a point."""
    return x - floats[t + 3 * k], y - floats[t + 3 * k + 1], z - floats[t + 3 * k + 2]


@lean_inlined
def dot(a, b, c, x, y, z):
    """Scalar product."""
    return a * x + b * y + c * z


@lean_inlined
def on_triangle(floats, t, x, y, z):
    """Weights of vertices 1 and 2 in the nearest point of a triangle, and its feature (Ericson 2005, 5.1.5)."""
    ax, ay, az = corner(floats, t, 0, x, y, z)
    bx, by, bz = corner(floats, t, 1, x, y, z)
    cx, cy, cz = corner(floats, t, 2, x, y, z)
    ux, uy, uz = ax - bx, ay - by, az - bz
    vx, vy, vz = ax - cx, ay - cy, az - cz
    d1, d2 = dot(ux, uy, uz, ax, ay, az), dot(vx, vy, vz, ax, ay, az)
    if d1 <= 0.0 and d2 <= 0.0:
        return 0.0, 0.0, VERTEX
    d3, d4 = dot(ux, uy, uz, bx, by, bz), dot(vx, vy, vz, bx, by, bz)
    if d3 >= 0.0 and d4 <= d3:
        return 1.0, 0.0, VERTEX + 1
    d5, d6 = dot(ux, uy, uz, cx, cy, cz), dot(vx, vy, vz, cx, cy, cz)
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 1.0, VERTEX + 2
    wc = d1 * d4 - d3 * d2
    if wc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return d1 / (d1 - d3), 0.0, EDGE
    wb = d5 * d2 - d1 * d6
    if wb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return 0.0, d2 / (d2 - d6), EDGE + 2
    wa = d3 * d6 - d5 * d4
    if wa <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 1.0 - w, w, EDGE + 1
    return wb / (wa + wb + wc), wc / (wa + wb + wc), FACE


@lean_inlined
def in_leaf(floats, ints, d, node, x, y, z, best, bx, by, bz, found, feature):
    """What is nearest to a point so far, with the triangles of a leaf: as `nearest`."""
    n = d + TREE + NODE * node
    for k in range(ints[n + FIRST], ints[n + FIRST] + ints[n + HELD]):
        t = ints[d + TRIANGLES] + TRIANGLE * k
        v, w, what = on_triangle(floats, t, x, y, z)
        ax, ay, az = corner(floats, t, 0, x, y, z)
        px, py, pz = corner(floats, t, 1, x, y, z)
        qx, qy, qz = corner(floats, t, 2, x, y, z)
        u = 1.0 - v - w
        ax, ay, az = u * ax + v * px + w * qx, u * ay + v * py + w * qy, u * az + v * pz + w * qz
        square = ax * ax + ay * ay + az * az
        if square <= best:
            best, bx, by, bz, found, feature = square, ax, ay, az, t, what
    return best, bx, by, bz, found, feature


@lean_inlined
def toward(floats, ints, d, x, y, z):
    """The leaf that is reached by taking the nearer of two boxes each time."""
    boxes = ints[d + BOXES]
    node = 0
    while ints[d + TREE + NODE * node + HELD] == 0:
        other = ints[d + TREE + NODE * (node + 1) + SKIP]
        first, second = outside2(floats, boxes + 6 * (node + 1), x, y, z), outside2(floats, boxes + 6 * other, x, y, z)
        node = node + 1 if first <= second else other
    return node


@lean(types.Tuple((F, F, F, F, N, N))(A, I, N, F, F, F, F), inner=True)
def nearest(floats, ints, at, x, y, z, within):
    """Vector from the nearest point of the surface to a point, its square, and offset and feature of the triangle;
    offset -1 where the surface is farther than ``within``."""
    d = ints[at + layout.DATA]
    # What is found in a near leaf bounds the distance, so that the walk looks into few others.
    begun = toward(floats, ints, d, x, y, z)
    best, bx, by, bz, found, feature = in_leaf(floats, ints, d, begun, x, y, z, within * within, 0.0, 0.0, 0.0, -1, 0)
    node = 0
    while node < ints[d + COUNT]:
        if outside2(floats, ints[d + BOXES] + 6 * node, x, y, z) > best:
            node = ints[d + TREE + NODE * node + SKIP]
            continue
        best, bx, by, bz, found, feature = in_leaf(floats, ints, d, node, x, y, z, best, bx, by, bz, found, feature)
        node += 1
    return best, bx, by, bz, found, feature


@lean(SURFACE_TYPE, inner=True)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal; on the surface that of the feature."""
    x, y, z = inward(floats, ints, at, x, y, z)
    square, a, b, c, t, feature = nearest(floats, ints, at, x, y, z, math.inf)
    k = t + NORMALS + 3 * feature
    side = math.copysign(1.0, dot(a, b, c, floats[k], floats[k + 1], floats[k + 2]))
    d = math.sqrt(square)
    if feature == FACE or d < 1e-12:
        a, b, c = floats[k], floats[k + 1], floats[k + 2]
    else:
        a, b, c = side * a / d, side * b / d, side * c / d
    a, b, c = turn(floats, ints[at + layout.ROTATION], a, b, c)
    return side * d, a, b, c


@lean(BEND_TYPE, inner=True)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """(v^2 - (v.n)^2 - (v.e)^2) / d around an edge of direction e, without e around a vertex; 0 over a face."""
    x, y, z = inward(floats, ints, at, x, y, z)
    vx, vy, vz = unturn(floats, ints[at + layout.ROTATION], vx, vy, vz)
    square, a, b, c, t, feature = nearest(floats, ints, at, x, y, z, math.inf)
    if feature == FACE or square < 1e-24:
        return 0.0
    across = dot(vx, vy, vz, vx, vy, vz) - dot(vx, vy, vz, a, b, c) ** 2 / square
    if feature < VERTEX:
        i = t + 3 * (feature - EDGE)
        j = t + 3 * ((feature - EDGE + 1) % 3)
        ex, ey, ez = floats[j] - floats[i], floats[j + 1] - floats[i + 1], floats[j + 2] - floats[i + 2]
        across -= dot(vx, vy, vz, ex, ey, ez) ** 2 / dot(ex, ey, ez, ex, ey, ez)
    return max(0.0, across) / math.sqrt(square)


@lean(CLEAR_TYPE, inner=True)
def clear(floats, ints, at, x, y, z, radius):
    """By the distance, searched no farther than the radius."""
    x, y, z = inward(floats, ints, at, x, y, z)
    return nearest(floats, ints, at, x, y, z, radius)[4] < 0
