# mypy: ignore-errors
"""Optical depth of a field on a grid along rays: exact for the trilinear interpolant."""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined

_rows = types.float64[:, ::1]
_reals = types.float64[::1]
GAUSS = 0.5 / math.sqrt(3.0)


@lean_inlined
def within(a, b, c, d, e, f, g, h, x, y, z):
    """The interpolant of a cell's corner values, x fastest, at a place from 0 to 1."""
    front = (1.0 - y) * (a + x * (b - a)) + y * (c + x * (d - c))
    back = (1.0 - y) * (e + x * (f - e)) + y * (g + x * (h - g))
    return front + z * (back - front)


@lean(types.void(_rows, _rows, _reals, types.float64[:, :, ::1], _reals, _reals, _reals))
def depths(starts, ways, ends, field, low, high, out):
    """Write the integral (n,) of a field over t along starts + t ways (n, 3), from t = 0 to ends (n,), in low..high.

    All in coordinates in which node (k, j, i) of the field stands at (i, j, k). Between nodes the interpolant along a
    ray is a cubic in t, which Gauss's two-point rule integrates exactly.
    """
    nz, ny, nx = field.shape
    values = field.reshape(nx * ny * nz)
    for n in range(starts.shape[0]):
        first = 0.0
        last = ends[n]
        for axis in range(3):
            start, way = starts[n, axis], ways[n, axis]
            if way == 0.0:
                if start < low[axis] or start > high[axis]:
                    last = -1.0
                continue
            near, far = (low[axis] - start) / way, (high[axis] - start) / way
            first = max(first, min(near, far))
            last = min(last, max(near, far))
        total = 0.0
        if not first < last:
            out[n] = total
            continue
        ox, oy, oz = starts[n, 0], starts[n, 1], starts[n, 2]
        dx, dy, dz = ways[n, 0], ways[n, 1], ways[n, 2]
        i = min(max(math.floor(ox + first * dx), 0), nx - 2)
        j = min(max(math.floor(oy + first * dy), 0), ny - 2)
        k = min(max(math.floor(oz + first * dz), 0), nz - 2)
        t = first
        while t < last:
            tx = (i + (1.0 if dx > 0.0 else 0.0) - ox) / dx if dx != 0.0 else math.inf
            ty = (j + (1.0 if dy > 0.0 else 0.0) - oy) / dy if dy != 0.0 else math.inf
            tz = (k + (1.0 if dz > 0.0 else 0.0) - oz) / dz if dz != 0.0 else math.inf
            end = min(min(tx, ty), min(tz, last))
            if end > t:
                middle, half = 0.5 * (t + end), GAUSS * (end - t)
                a, b = middle - half, middle + half
                at = (k * ny + j) * nx + i
                up = at + nx
                c0, c1, c2, c3 = values[at], values[at + 1], values[up], values[up + 1]
                at, up = at + nx * ny, up + nx * ny
                c4, c5, c6, c7 = values[at], values[at + 1], values[up], values[up + 1]
                both = within(c0, c1, c2, c3, c4, c5, c6, c7, ox + a * dx - i, oy + a * dy - j, oz + a * dz - k)
                both += within(c0, c1, c2, c3, c4, c5, c6, c7, ox + b * dx - i, oy + b * dy - j, oz + b * dz - k)
                total += 0.5 * (end - t) * both
                t = end
            if end >= last:
                break
            if tx <= end:
                i += 1 if dx > 0.0 else -1
            elif ty <= end:
                j += 1 if dy > 0.0 else -1
            else:
                k += 1 if dz > 0.0 else -1
            if i < 0 or j < 0 or k < 0 or i > nx - 2 or j > ny - 2 or k > nz - 2:
                break
        out[n] = total
