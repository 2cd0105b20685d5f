# mypy: ignore-errors
"""Counter-based chance in compiled code: the numbers of quantities.chance, and smooth noise in time made of them."""

import math

from numba import types

from sceneql.compiled.kernels import inlined, lean
from sceneql.system.signatures_kernels import F


@inlined
def philox(first, second, key):
    """Philox2x32-10, as quantities.chance.philox: words below 2^32 as int64."""
    for _ in range(10):
        product = (first * 0xD256D193) & 0xFFFFFFFFFFFFFFFF
        high = (product >> 32) & 0xFFFFFFFF
        first, second = high ^ key ^ second, product & 0xFFFFFFFF
        key = (key + 0x9E3779B9) & 0xFFFFFFFF
    return first, second


@inlined
def signed(i, j, key):
    """Uniform in [-1, 1) for integers i, j under a key."""
    first, second = philox(i & 0xFFFFFFFF, j & 0xFFFFFFFF, key & 0xFFFFFFFF)
    return float((first << 21) | (second >> 11)) * 2.0**-52 - 1.0


@inlined
def noise_in_time(s, channel, key):
    """Smooth noise: the uniform cubic B-spline (twice differentiable) of control values in [-1, 1) at whole s."""
    below = math.floor(s)
    f = s - below
    i = int(below)
    g = 1.0 - f
    a = g * g * g
    b = 4.0 - 6.0 * f * f + 3.0 * f * f * f
    c = 4.0 - 6.0 * g * g + 3.0 * g * g * g
    d = f * f * f
    total = a * signed(i - 1, channel, key) + b * signed(i, channel, key)
    total += c * signed(i + 1, channel, key) + d * signed(i + 2, channel, key)
    return total / 6.0


@lean(types.float64(F, F, F))
def uniform(i, j, k):
    """The number of `random`, as quantities.chance.random: in [0, 1) for the whole parts of i, j, k modulo 2^32."""
    if not (math.isfinite(i) and math.isfinite(j) and math.isfinite(k)):
        return math.nan
    first = int(math.floor(i) % 4294967296.0)
    second = int(math.floor(j) % 4294967296.0)
    high, low = philox(first, second, int(math.floor(k) % 4294967296.0))
    return float((high << 21) | (low >> 11)) * 2.0**-53
