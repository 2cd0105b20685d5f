# mypy: ignore-errors
"""Distances of points from triangles and between edges, with the places that are nearest."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, F, N

SEVEN, SIX = types.UniTuple(F, 7), types.UniTuple(F, 6)


@lean(SEVEN(A, N, N, N, N))
def point_triangle(x, p, a, b, c):
    """(distance, unit normal towards the point (3), weights of the triangle's corners (3)); corners at x[a : a + 3].

    By the regions of Ericson, Real-Time Collision Detection (2005), 5.1.5. The normal is 0 where the point touches.
    """
    ux, uy, uz = x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]
    vx, vy, vz = x[c] - x[a], x[c + 1] - x[a + 1], x[c + 2] - x[a + 2]
    wx, wy, wz = x[p] - x[a], x[p + 1] - x[a + 1], x[p + 2] - x[a + 2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    d1, d2 = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    d3, d4, d5, d6 = d1 - uu, d2 - uv, d1 - uv, d2 - vv
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0.0 and d2 <= 0.0:
        s, t = 0.0, 0.0
    elif d3 >= 0.0 and d4 <= d3:
        s, t = 1.0, 0.0
    elif d6 >= 0.0 and d5 <= d6:
        s, t = 0.0, 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        s, t = d1 / (d1 - d3), 0.0
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        s, t = 0.0, d2 / (d2 - d6)
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        s = 1.0 - t
    else:
        whole = va + vb + vc
        s, t = vb / whole, vc / whole
    nx, ny, nz = wx - s * ux - t * vx, wy - s * uy - t * vy, wz - s * uz - t * vz
    d = math.sqrt(nx * nx + ny * ny + nz * nz)
    scale = 1.0 / d if d > 0.0 else 0.0
    return d, scale * nx, scale * ny, scale * nz, 1.0 - s - t, s, t


@lean(SIX(A, N, N, N, N))
def edge_edge(x, a, b, c, d):
    """(distance, unit normal towards the first edge (3), places along both edges (2)); ends at x[a : a + 3], ...

    By clamping (Ericson 2005, 5.1.9), from all candidates of nearly parallel edges, too.
    """
    ux, uy, uz = x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]
    vx, vy, vz = x[d] - x[c], x[d + 1] - x[c + 1], x[d + 2] - x[c + 2]
    wx, wy, wz = x[a] - x[c], x[a + 1] - x[c + 1], x[a + 2] - x[c + 2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    across = uu * vv - uv * uv
    s = min(1.0, max(0.0, (uv * vw - vv * uw) / across)) if across > 1e-14 * uu * vv else 0.0
    t = (uv * s + vw) / vv
    if t < 0.0:
        t = 0.0
        s = min(1.0, max(0.0, -uw / uu))
    elif t > 1.0:
        t = 1.0
        s = min(1.0, max(0.0, (uv - uw) / uu))
    nx, ny, nz = wx + s * ux - t * vx, wy + s * uy - t * vy, wz + s * uz - t * vz
    distance = math.sqrt(nx * nx + ny * ny + nz * nz)
    scale = 1.0 / distance if distance > 0.0 else 0.0
    return distance, scale * nx, scale * ny, scale * nz, s, t
