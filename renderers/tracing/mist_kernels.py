# mypy: ignore-errors
"""How much a field on a grid absorbs along rays: exact for the trilinear interpolant."""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined

_rows = types.float64[:, ::1]
_reals = types.float64[::1]
GAUSS = 0.5 / math.sqrt(3.0)


@lean_inlined
def within(field, i, j, k, x, y, z):
    """The interpolant at a place inside cell (i, j, k) of nodes."""
    x, y, z = x - i, y - j, z - k
    low = (1.0 - x) * field[k, j, i] + x * field[k, j, i + 1]
    up = (1.0 - x) * field[k, j + 1, i] + x * field[k, j + 1, i + 1]
    front = (1.0 - y) * low + y * up
    low = (1.0 - x) * field[k + 1, j, i] + x * field[k + 1, j, i + 1]
    up = (1.0 - x) * field[k + 1, j + 1, i] + x * field[k + 1, j + 1, i + 1]
    return (1.0 - z) * front + z * ((1.0 - y) * low + y * up)


@lean(types.void(_rows, _rows, _reals, types.float64[:, :, ::1], _reals, _reals, _reals))
def depths(starts, ways, ends, field, low, high, out):
    """Write the integral (n,) of a field over t along starts + t ways (n, 3), from t = 0 to ends (n,), in low..high.

    All in coordinates in which node (k, j, i) of the field stands at (i, j, k). Between nodes the interpolant along a
    ray is a cubic of t, which Gauss's rule of two points integrates exactly.
    """
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
        i = min(max(math.floor(ox + first * dx), 0), field.shape[2] - 2)
        j = min(max(math.floor(oy + first * dy), 0), field.shape[1] - 2)
        k = min(max(math.floor(oz + first * dz), 0), field.shape[0] - 2)
        t = first
        while t < last:
            tx = (i + (1.0 if dx > 0.0 else 0.0) - ox) / dx if dx != 0.0 else math.inf
            ty = (j + (1.0 if dy > 0.0 else 0.0) - oy) / dy if dy != 0.0 else math.inf
            tz = (k + (1.0 if dz > 0.0 else 0.0) - oz) / dz if dz != 0.0 else math.inf
            end = min(min(tx, ty), min(tz, last))
            if end > t:
                middle, half = 0.5 * (t + end), GAUSS * (end - t)
                a, b = middle - half, middle + half
                sum2 = within(field, i, j, k, ox + a * dx, oy + a * dy, oz + a * dz)
                sum2 += within(field, i, j, k, ox + b * dx, oy + b * dy, oz + b * dz)
                total += 0.5 * (end - t) * sum2
                t = end
            if end >= last:
                break
            if tx <= end:
                i += 1 if dx > 0.0 else -1
            elif ty <= end:
                j += 1 if dy > 0.0 else -1
            else:
                k += 1 if dz > 0.0 else -1
            if i < 0 or j < 0 or k < 0 or i > field.shape[2] - 2 or j > field.shape[1] - 2 or k > field.shape[0] - 2:
                break
        out[n] = total
