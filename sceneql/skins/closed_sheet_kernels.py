# mypy: ignore-errors
"""A closed sheet of triangles: its tension, its laws, and what keeps the volume inside."""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.skins.skin_layout import (
    CORNERS,
    COUNT,
    FORCE_AT,
    NORMALS_AT,
    POSITION_AT,
    PRETENSION_AT,
    REST_AT,
    SIDES,
    TALLY_AT,
    VOLUME_AT,
)
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, F, I, N

MOST = 20
"""Newton's updates of the volume."""
ROUNDING = 4e-16
"""Of a sum of as many volumes as triangles, in parts of the whole, where updates end."""


@lean_inlined
def away(y, a, b):
    """From one place in y to another [m]."""
    return y[b] - y[a], y[b + 1] - y[a + 1], y[b + 2] - y[a + 2]


@lean_inlined
def cross(a, b):
    """The cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@lean_inlined
def add(floats, at, factor, vector):
    """Add so many times a vector to three floats."""
    for k in range(3):
        floats[at + k] += factor * vector[k]


@lean(TERM, inner=True)
def tension(t, y, rate, floats, ints):
    """Adds -tension dA/dX, A the area of the sheet [N]."""
    at, force, pull = ints[POSITION_AT], ints[FORCE_AT], floats[ints[PRETENSION_AT]]
    for c in range(CORNERS, ints.size, 3):
        i, j, k = ints[c], ints[c + 1], ints[c + 2]
        ab, ac = away(y, at + 3 * i, at + 3 * j), away(y, at + 3 * i, at + 3 * k)
        n = cross(ab, ac)
        size = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        if size > 0.0:
            half = 0.5 * pull / size
            add(floats, force + 3 * j, half, cross(n, ac))
            add(floats, force + 3 * k, half, cross(ab, n))
            add(floats, force + 3 * i, half, cross(n, (ab[0] - ac[0], ab[1] - ac[1], ab[2] - ac[2])))


@lean(TERM, inner=True)
def springs(t, y, rate, floats, ints):
    """Adds stiffness (length - own length) along each side [N]."""
    at, force, count = ints[POSITION_AT], ints[FORCE_AT], (ints.size - SIDES) // 2
    stiffness, lengths = floats[ints[PRETENSION_AT] :], floats[ints[REST_AT] :]
    for s in range(count):
        a, b = ints[SIDES + 2 * s], ints[SIDES + 2 * s + 1]
        d = away(y, at + 3 * a, at + 3 * b)
        length = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        if length > 0.0:
            pull = stiffness[s] * (1.0 - lengths[s] / length)
            add(floats, force + 3 * a, pull, d)
            add(floats, force + 3 * b, -pull, d)


@lean(types.void(A, A, F, F, N, I), inner=True)
def strained(y, floats, shear, area, rubber, ints):
    """Adds the forces of an energy W of tr C and det C, C = F^T F in the sheet, on each square meter at the start.

    F has the columns (xj - xi, xk - xi) times the inverse of those at the start, an upper triangle (p, q; 0, r), and P
    = 2 dW/dtr F + 2 dW/ddet F cof C is dW/dF. ``rubber``: 1: W = shear (tr + 1/det - 3)/2, else W = shear ((i^2 + 2 i -
    2 k)/4 + area k^2/4) with i = tr - 2, k = det - 1.
    """
    at, force = ints[POSITION_AT], ints[FORCE_AT]
    for c in range(CORNERS, ints.size, 3):
        i, j, k = ints[c], ints[c + 1], ints[c + 2]
        ab, ac = away(y, at + 3 * i, at + 3 * j), away(y, at + 3 * i, at + 3 * k)
        rest = floats[ints[REST_AT] + 4 * ((c - CORNERS) // 3) :]
        p, q, r, whole = rest[0], rest[1], rest[2], rest[3]
        u = (p * ab[0], p * ab[1], p * ab[2])
        v = (q * ab[0] + r * ac[0], q * ab[1] + r * ac[1], q * ab[2] + r * ac[2])
        uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
        uv = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
        vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
        square = uu * vv - uv * uv
        if rubber == 1:
            by_trace, by_square = shear, -shear / (square * square)
        else:
            by_trace, by_square = shear * (uu + vv - 1.0), shear * (area * (square - 1.0) - 1.0)
        for d in range(3):
            along = whole * (by_trace * u[d] + by_square * (vv * u[d] - uv * v[d]))
            across = whole * (by_trace * v[d] + by_square * (uu * v[d] - uv * u[d]))
            first, second = p * along + q * across, r * across
            floats[force + 3 * j + d] -= first
            floats[force + 3 * k + d] -= second
            floats[force + 3 * i + d] += first + second


@lean(TERM, inner=True)
def neo_hookean(t, y, rate, floats, ints):
    """A sheet of rubber that keeps its own volume (Barthes-Biesel & Rallison 1981, J. Fluid Mech. 113, 251-267)."""
    strained(y, floats, floats[ints[PRETENSION_AT]], 0.0, 1, ints)


@lean(TERM, inner=True)
def skalak(t, y, rate, floats, ints):
    """The skin of a blood cell, that resists a change of its area (Skalak et al. 1973, Biophys. J. 13, 245-264)."""
    strained(y, floats, floats[ints[PRETENSION_AT]], floats[ints[PRETENSION_AT] + 1], 0, ints)


@lean_inlined
def volume(y, at, ints):
    """What a closed sheet goes around, counterclockwise from outside (divergence theorem)."""
    total = 0.0
    for c in range(CORNERS, ints.size, 3):
        a = away(y, at, at + 3 * ints[c])
        n = cross(away(y, at, at + 3 * ints[c + 1]), away(y, at, at + 3 * ints[c + 2]))
        total += a[0] * n[0] + a[1] * n[1] + a[2] * n[2]
    return total / 6.0


@lean_inlined
def vertex_normals(y, at, ints, count, out):
    """(count, 3) the derivative of the volume by each vertex, in a row; the sum of their squares."""
    for k in range(3 * count):
        out[k] = 0.0
    for c in range(CORNERS, ints.size, 3):
        i, j, k = ints[c], ints[c + 1], ints[c + 2]
        n = cross(away(y, at + 3 * i, at + 3 * j), away(y, at + 3 * i, at + 3 * k))
        add(out, 3 * i, 1.0 / 6.0, n)
        add(out, 3 * j, 1.0 / 6.0, n)
        add(out, 3 * k, 1.0 / 6.0, n)
    total = 0.0
    for k in range(3 * count):
        total += out[k] * out[k]
    return total


@lean(AFTER_STEP, inner=True)
def keep_volume(t0, t1, y0, rate0, y1, floats, ints):
    """Moves the vertices by s dV/dX so that the volume is what it was; at the end of a step sums what that put back.

    That is far less than a step's error, and so the rate stays.
    """
    count, at, wanted = ints[COUNT], ints[POSITION_AT], floats[ints[VOLUME_AT]]
    normals = floats[ints[NORMALS_AT] : ints[NORMALS_AT] + 3 * count]
    left = wanted - volume(y1, at, ints)
    if t1 > t0:
        y1[ints[TALLY_AT]] += abs(left)
    for _ in range(MOST):
        if not abs(left) > ROUNDING * wanted:
            break
        s = left / vertex_normals(y1, at, ints, count, normals)
        for k in range(3 * count):
            y1[at + k] += s * normals[k]
        before, left = left, wanted - volume(y1, at, ints)
        if abs(left) >= 0.5 * abs(before):
            break
    return False
