# mypy: ignore-errors
"""Density fields of skeleton parts: values, gradients and enclosures.

A part has the density weight (1 - d^2/R^2)^3 within its radius R and 0 beyond, d the distance to the segment from a
to b (Wyvill, McPheeters & Wyvill 1986); a point is the segment with a = b.
"""

import numpy as np

from sceneql.compiled.kernels import inlined


@inlined
def offset(parts, i, x, y, z):
    """Vector from the nearest point of part i's segment to (x, y, z)."""
    ax = parts[i, 0]
    ay = parts[i, 1]
    az = parts[i, 2]
    wx = x - ax
    wy = y - ay
    wz = z - az
    sx = parts[i, 3] - ax
    sy = parts[i, 4] - ay
    sz = parts[i, 5] - az
    length2 = sx * sx + sy * sy + sz * sz
    if length2 > 0.0:
        q = min(max((wx * sx + wy * sy + wz * sz) / length2, 0.0), 1.0)
        wx -= q * sx
        wy -= q * sy
        wz -= q * sz
    return wx, wy, wz


@inlined
def density_value(parts, start, stop, x, y, z):
    """Sum of the densities of parts start..stop-1 at a point; NaN at a point that is not finite."""
    if not np.isfinite(x + y + z):
        return np.nan
    total = 0.0
    for i in range(start, stop):
        wx, wy, wz = offset(parts, i, x, y, z)
        radius = parts[i, 6]
        u = 1.0 - (wx * wx + wy * wy + wz * wz) / (radius * radius)
        if u > 0.0:
            total += parts[i, 7] * (u * u * u)
    return total


@inlined
def density_gradient(parts, start, stop, x, y, z):
    """Gradient of ``density_value`` with respect to the point."""
    gx = gy = gz = 0.0
    for i in range(start, stop):
        wx, wy, wz = offset(parts, i, x, y, z)
        radius = parts[i, 6]
        u = 1.0 - (wx * wx + wy * wy + wz * wz) / (radius * radius)
        if u > 0.0:
            slope = -6.0 * parts[i, 7] * u * u / (radius * radius)
            gx += slope * wx
            gy += slope * wy
            gz += slope * wz
    return gx, gy, gz
