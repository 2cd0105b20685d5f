# mypy: ignore-errors
"""Bounds of the second derivatives of densities of points in a box."""

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.interval_kernels import outward, squared
from sceneql.field.enclose.slope_kernels import times
from sceneql.field.skeleton.skeleton_bounds_kernels import ULPS, box_of

NONE = 1.0e-200
"""Slope that is none but for rounding."""


@inlined
def along_axes(scratch, second, p):
    """Whether each of the point's rows p..p+2 goes evenly along an axis of its own."""
    for row in range(3):
        for axis in range(3):
            at, to = 2 * axis, 2 * axis + 1
            if abs(second[p + row, at]) + abs(second[p + row, to]) > NONE:
                return False
            if row != axis and abs(scratch[p + row, at + 2]) + abs(scratch[p + row, to + 2]) > NONE:
                return False
    return True


@inlined
def density_curvature(parts, start, stop, scratch, second, k, p):
    """Bounds into row k of ``second``, for the box of rows p..p+2 of scratch; whether they are known.

    They are of points, in coordinates that go ``along_axes``. With s = 1 - d^2 / R^2, above 0, the second derivative of
    w s^3 along x is -6 w / R^2 (s^2 - 4 s x^2 / R^2).
    """
    if not along_axes(scratch, second, p):
        return False
    for i in range(start, stop):
        if parts[i, 0] != parts[i, 3] or parts[i, 1] != parts[i, 4] or parts[i, 2] != parts[i, 5]:
            return False
    x, y, z, hx, hy, hz = box_of(scratch, p)
    size, bulk = ULPS * (abs(x) + abs(y) + abs(z) + hx + hy + hz), 0.0
    for column in range(6):
        second[k, column] = 0.0
    for i in range(start, stop):
        u, v, w = abs(x - parts[i, 0]), abs(y - parts[i, 1]), abs(z - parts[i, 2])
        nx, ny, nz = max(u - hx - size, 0.0), max(v - hy - size, 0.0), max(w - hz - size, 0.0)
        square = parts[i, 6] * parts[i, 6]
        most = 1.0 - (nx * nx + ny * ny + nz * nz) / square * (1.0 - ULPS)
        if most <= 0.0:
            continue
        fx, fy, fz = u + hx + size, v + hy + size, w + hz + size
        away = (fx * fx + fy * fy + fz * fz) / square * (1.0 + ULPS)
        least = max(1.0 - away, 0.0)
        factor = -6.0 * parts[i, 7] / square
        for axis in range(3):
            near, far = (nx, fx) if axis == 0 else (ny, fy) if axis == 1 else (nz, fz)
            low, high = times(
                least * least - 4.0 * most * far * far / square, most * most - 4.0 * least * near * near / square,
                factor, factor,
            )  # fmt: skip
            second[k, 2 * axis] += low
            second[k, 2 * axis + 1] += high
        bulk += abs(factor) * (most + 4.0 * away) * most
    bulk *= 8.0 * ULPS
    for axis in range(3):
        at, to = 2 * axis, 2 * axis + 1
        low, high = squared(scratch[p + axis, at + 2], scratch[p + axis, to + 2])
        low, high = outward(low, high)
        low, high = times(second[k, at] - bulk, second[k, to] + bulk, low, high)
        second[k, at], second[k, to] = low, high
        if not (low > -1.0e300 and high < 1.0e300):
            return False
    return True
