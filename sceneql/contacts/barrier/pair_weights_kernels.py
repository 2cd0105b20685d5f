# mypy: ignore-errors
"""A pair of a vertex and a triangle or of two edges as four vertices with weights: their distance is |sum of w x|."""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.distance_kernels import edge_edge, point_triangle
from sceneql.contacts.barrier.pairs_kernels import FREE, corner, end, vertex
from sceneql.system.signatures_kernels import A, F, I, N

TWELVE = types.UniTuple(F, 12)
PARALLEL = 1e-3
"""Square of the sine between edges at the start's lengths below which their barrier fades, so that its force is smooth
where the nearest places of parallel edges are no single pair (Li et al. 2020, 4.2)."""


@lean_inlined
def node(floats, ints, m, edges, k):
    """Vertex k of the four of pair m."""
    if edges:
        at = ints[layout.EDGES_AT] + 2 * m
        return end(ints, int(floats[at + k // 2]), k % 2)
    at = ints[layout.POINTS_AT] + 2 * m
    return int(floats[at + 1]) if k == 0 else corner(ints, int(floats[at]), k - 1)


@lean_inlined
def product(x, a, b, c, d):
    """The vector product of two edges."""
    ux, uy, uz = x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]
    vx, vy, vz = x[d] - x[c], x[d + 1] - x[c + 1], x[d + 2] - x[c + 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@lean_inlined
def square(x, a, b):
    """The square of the length of an edge."""
    u, v, w = x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]
    return u * u + v * v + w * w


@lean(TWELVE(A, I, N, types.boolean))
def stencil(floats, ints, m, edges):
    """(distance, normal (3), weights (4), gap, stiffness times area, share, its slope) of pair m of vertices NOW.

    The distance is infinite where it is beyond the gap. Of edges that are nearly parallel the share of the barrier is
    below 1; its slope is that by the square of their vector product.
    """
    i, j, k, n = (
        node(floats, ints, m, edges, 0),
        node(floats, ints, m, edges, 1),
        node(floats, ints, m, edges, 2),
        node(floats, ints, m, edges, 3),
    )
    a, c, now = vertex(ints, i), vertex(ints, k), ints[layout.NOW]
    p, q, r, s = now + 3 * i, now + 3 * j, now + 3 * k, now + 3 * n
    gap = floats[ints[layout.NUMBERS] + layout.GAP]
    rest = ints[layout.REST]
    if edges:
        found, nx, ny, nz, u, v = edge_edge(floats, p, q, r, s)
        w0, w1, w2, w3 = 1.0 - u, u, v - 1.0, -v
    else:
        found, nx, ny, nz, w1, w2, w3 = point_triangle(floats, p, q, r, s)
        w0, w1, w2, w3 = 1.0, -w1, -w2, -w3
    if found < gap and ints[a + layout.BODY] == ints[c + layout.BODY]:
        i, j, k, n = rest + 3 * i, rest + 3 * j, rest + 3 * k, rest + 3 * n
        apart = edge_edge(floats, i, j, k, n)[0] if edges else point_triangle(floats, i, j, k, n)[0]
        gap = min(gap, FREE * apart)
    if not found < gap:
        return math.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, gap, 0.0, 1.0, 0.0
    stiffness, areas = ints[layout.STIFFNESS], ints[layout.AREAS]
    first, second = node(floats, ints, m, edges, 0), node(floats, ints, m, edges, 2)
    modulus = min(floats[stiffness + first], floats[stiffness + second])
    share, slope = 1.0, 0.0
    if edges:
        at = ints[layout.EDGES_AT] + 2 * m
        areas += ints[layout.VERTICES]
        area = 0.25 * (floats[areas + int(floats[at])] + floats[areas + int(floats[at + 1])])
        x, y, z = product(floats, p, q, r, s)
        across = x * x + y * y + z * z
        i, j, k, n = (
            node(floats, ints, m, edges, 0),
            node(floats, ints, m, edges, 1),
            node(floats, ints, m, edges, 2),
            node(floats, ints, m, edges, 3),
        )
        fade = PARALLEL * square(floats, rest + 3 * i, rest + 3 * j) * square(floats, rest + 3 * k, rest + 3 * n)
        if across < fade:
            part = across / fade
            share, slope = (2.0 - part) * part, (2.0 - 2.0 * part) / fade
    else:
        area = floats[areas + first]
    return found, nx, ny, nz, w0, w1, w2, w3, gap, modulus * area, share, slope


@lean_inlined
def listed(floats, ints, edges):
    """How many pairs of a kind there are."""
    return int(floats[ints[layout.MEMORY] + (layout.EDGE_PAIRS if edges else layout.POINT_PAIRS)])
