# mypy: ignore-errors
"""Gradient noise in compiled code: the numbers of quantities.noise, bit by bit."""

import math

from numba import types

from sceneql.compiled.chance_kernels import philox
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import F

FADE = (0.0, 0.0, 0.0, 10.0, -15.0, 6.0, 0.0)


@lean_inlined
def weights(f, order):
    """(a, u, b, v): derivatives of the weight and of the weight times the way from there, of the corners at 0 and 1."""
    fade, faded = 0.0, 0.0
    for power in range(6, order - 1, -1):
        steep = 1.0
        for k in range(order):
            steep *= power - k
        fade, faded = fade * f + steep * FADE[power], faded * f + steep * FADE[power - 1]
    one = 1.0 if order == 0 else 0.0
    way = f if order == 0 else 1.0 if order == 1 else 0.0
    return one - fade, way - faded, fade, faded - fade


@lean_inlined
def word(whole):
    """A whole number modulo 2^32."""
    return int(whole % 4294967296.0)


@lean_inlined
def slope(i):
    """Evenly from -2 to 2."""
    first, second = philox(i, 0, 0)
    return 4.0 * (float((first << 21) | (second >> 11)) * 2.0**-53) - 2.0


@lean(types.float64(F, F))
def noise_line(x, order):
    """Noise of one number, or its derivative of an order."""
    if not math.isfinite(x):
        return math.nan
    f = x % 1.0
    _, near, _, far = weights(f, int(order))
    return slope(word(x - f)) * near + slope(word(x - f + 1.0)) * far


@lean(types.float64(F, F, F, F))
def noise_space(x, y, z, order):
    """Noise of three numbers, or its derivative of an order: along x + 8 along y + 64 along z."""
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        return math.nan
    f, g, h = x % 1.0, y % 1.0, z % 1.0
    along = int(order)
    a0, u0, a1, u1 = weights(f, along % 8)
    b0, v0, b1, v1 = weights(g, along // 8 % 8)
    c0, w0, c1, w1 = weights(h, along // 64)
    total = 0.0
    for corner in range(8):
        i, j, k = corner & 1, corner >> 1 & 1, corner >> 2
        a, u = (a1, u1) if i else (a0, u0)
        b, v = (b1, v1) if j else (b0, v0)
        c, w = (c1, w1) if k else (c0, w0)
        chosen, _ = philox(word(x - f + i), word(y - g + j), word(z - h + k))
        chosen &= 15
        along_x, along_y, along_z = u * b * c, a * v * c, a * b * w
        first = along_x if chosen < 8 else along_y
        second = along_y if chosen < 4 else along_x if chosen == 12 or chosen == 14 else along_z
        total += (-first if chosen & 1 else first) + (-second if chosen & 2 else second)
    return total
