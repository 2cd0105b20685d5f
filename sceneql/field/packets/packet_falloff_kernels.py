# mypy: ignore-errors
"""Kernels of densities in lanes of float32: enclosures of K(s) for any kernel that is convex and does not increase."""

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below, root, spread
from sceneql.field.packets.packet_density_kernels import GROW, HALF, ONE, PAD, ZERO, F
from sceneql.field.skeleton.falloff_kernels import CUT, GAUSSIAN, METABALL, SHARPNESS, SOFT_OBJECT, WHOLE

K, TAIL, OVER = F(SHARPNESS), F(CUT), F(1.0 / WHOLE)
ROUGH = F(8.0e-6)
"""Rounding error of K, which is at most 1."""
NINTH, THIRD = F(1.0 / 9.0), F(1.0 / 3.0)


@inlined
def falling_exponential(x):
    """exp(-x) for x in [0, 4]: Taylor's polynomial of x/16, squared four times."""
    y = x * F(0.0625)
    p = ONE - y * (ONE - y * (HALF - y * (F(1 / 6) - y * (F(1 / 24) - y * (F(1 / 120) - y * F(1 / 720))))))
    p = p * p
    p = p * p
    p = p * p
    return p * p


@inlined
def falls(kind, s):
    """(K, dK/ds) as in falloff_kernels at s >= 0, for all kernels but Wyvill's."""
    s = below(s, ONE, s, ONE)
    u = ONE - s
    if kind == F(SOFT_OBJECT):
        return u * u * (ONE - F(4.0 / 9.0) * s), u * (F(12.0 / 9.0) * s - F(22.0 / 9.0))
    if kind == F(METABALL):
        r = root(s)
        v = ONE - r
        far = below(r, THIRD, THIRD, r)
        return below(s, NINTH, ONE - F(3.0) * s, F(1.5) * v * v), F(1.5) - F(1.5) / far
    if kind == F(GAUSSIAN):
        f = falling_exponential(K * s)
        return (f - TAIL * (ONE + K * u)) * OVER, (TAIL - f) * (K * OVER)
    under = ONE + K * s
    return u * u / under, u * (F(-2.0) * under - K * u) / (under * under)


@inlined
def fallen(kind, a0, a1, a2, error):
    """K(s) for 1 - s = a0 + a1 tau - a2 tau^2 +- error as packet_density_kernels.cubed gives it, and the largest K.

    The tangent in the middle of the range of s, or the hull where that is narrower.
    """
    es = error + HALF * a2 + PAD * (abs(a0) + a2 + ONE)
    s0, s1 = (ONE - a0) + HALF * a2, ZERO - a1
    reach = (abs(s1) + es) * GROW
    low = s0 - reach
    low = below(low, ZERO, ZERO, low)
    high = s0 + reach
    high = below(high, low, low, high)
    middle, half = HALF * (low + high), HALF * (high - low)
    value, slope = falls(kind, middle)
    # Rounding may give a positive slope, or one beyond the reach.
    slope = below(middle, ONE, below(slope, ZERO, slope, ZERO), ZERO)
    at_low, _ = falls(kind, low)
    at_high, _ = falls(kind, high)
    gap = at_low - (value - slope * half)
    more = at_high - (value + slope * half)
    gap = below(gap, more, more, gap)
    gap = HALF * below(gap, ZERO, ZERO, gap)
    e = gap - slope * es + ROUGH * (ONE + half) - F(4.0) * PAD * slope * (abs(s0) + middle + half)
    flat = HALF * (at_low - at_high) + ROUGH
    c0 = below(e, flat, value + slope * (s0 - middle) + gap, HALF * (at_low + at_high))
    c1 = below(e, flat, slope * s1 * THIRD, ZERO)
    # NaN must not become a density of 0.
    return c0 + ZERO * (s0 + s1 + es), c1, spread(ZERO), below(e, flat, e, flat), at_low + ROUGH
