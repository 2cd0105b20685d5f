# mypy: ignore-errors
"""First-order enclosures of single operations in float32, without branches, so that loops over lanes vectorize.

Operands and results are c0 + c1 tau +- e, tau in [-1, 1], as in enclosure_kernels in float64. Rounding is covered
twice: by PAD times the magnitudes added, in e, and by GROW for the rounding of e itself. NaN and infinity are
propagated: an operation that would lose those of its arguments does not.
"""

import numpy as np

from sceneql.field.tape import single_kernels as single
from sceneql.field.tape.single_kernels import LOG_ERROR, lane

F = np.float32
PAD = F(5.0e-7)
"""Eight half units in the last place."""
GROW = F(1.0 + 2.0e-6)
TINY = F(1.0e-37)
"""Larger than the loss by underflow."""
LEAST = F(1.0e-30)
FAR = F(1.0e18)
"""Up to this size the square of a reciprocal does not underflow."""
ZERO, HALF, ONE, TWO, QUARTER = F(0.0), F(0.5), F(1.0), F(2.0), F(0.25)
INFINITE = F(np.inf)
WAVES = F(1.5)
PI = F(3.14159274)
"""The float32 next above pi."""


@lane
def total(a0, a1, ea, b0, b1, eb):
    """Enclosure of a sum."""
    c0 = a0 + b0
    c1 = a1 + b1
    return c0, c1, (ea + eb) * GROW + PAD * (abs(c0) + abs(c1))


@lane
def difference(a0, a1, ea, b0, b1, eb):
    """Enclosure of a difference."""
    c0 = a0 - b0
    c1 = a1 - b1
    return c0, c1, (ea + eb) * GROW + PAD * (abs(c0) + abs(c1))


@lane
def product(a0, a1, ea, b0, b1, eb):
    """Enclosure of a product: a1 b1 tau^2 lies in a1 b1 [0, 1]."""
    second = HALF * (a1 * b1)
    size_a = abs(a0) + abs(a1)
    size_b = abs(b0) + abs(b1)
    e = abs(second) + ea * (size_b + eb) + eb * size_a
    return a0 * b0 + second, a0 * b1 + a1 * b0, e * GROW + (PAD * size_a * size_b + TINY)


@lane
def squared(a0, a1, ea):
    """Enclosure of a square."""
    second = HALF * (a1 * a1)
    size = abs(a0) + abs(a1)
    e = second + ea * (size + size + ea)
    return a0 * a0 + second, TWO * (a0 * a1), e * GROW + (PAD * size * size + TINY)


@lane
def scaled(a0, a1, ea, s, es):
    """Enclosure of a product with the constant s +- es."""
    c0 = a0 * s
    c1 = a1 * s
    e = ea * (abs(s) + es) + (abs(a0) + abs(a1)) * es
    return c0, c1, e * GROW + (PAD * (abs(c0) + abs(c1)) + TINY)


@lane
def clamped(x):
    """x clamped to [0, 1]; NaN becomes 0."""
    x = x if x > ZERO else ZERO
    return x if x < ONE else ONE


@lane
def larger_of(a0, a1, ea, b0, b1, eb):
    """Enclosure of max(a, b): b + the chord of max(a - b, 0), or the constant hull where that is better.

    With any share s of [0, 1], max(d, 0) - s d lies in [0, max((1 - s) high, -s low)] for d in [low, high].
    """
    d0 = a0 - b0
    reach = (abs(a1 - b1) + ea + eb) * GROW + PAD * (abs(a0) + abs(b0) + abs(a1) + abs(b1)) + TINY
    reach = ZERO if (ea == ZERO and eb == ZERO and a1 == ZERO and b1 == ZERO) else reach
    s = clamped(HALF + HALF * d0 / (reach + TINY))
    high = (d0 + reach) * (ONE - s)
    low = (reach - d0) * s
    gap = HALF * (high if high > low else low)
    gap = gap if gap > ZERO else ZERO
    c0 = s * a0 + (ONE - s) * b0 + gap
    c1 = s * a1 + (ONE - s) * b1
    plain = s == ZERO or s == ONE
    e = (s * ea + (ONE - s) * eb + gap) * GROW
    e = e if plain else e + PAD * (abs(a0) + abs(b0) + abs(a1) + abs(b1))
    reach_a = abs(a1) + ea
    reach_b = abs(b1) + eb
    bottom = a0 - reach_a if a0 - reach_a > b0 - reach_b else b0 - reach_b
    top = a0 + reach_a if a0 + reach_a > b0 + reach_b else b0 + reach_b
    flat = HALF * (top - bottom)
    flat_e = flat * GROW + PAD * (abs(bottom) + abs(top)) + TINY
    better = flat_e < e or (bottom > ZERO and c0 - abs(c1) <= e)
    better = better and ZERO * (c0 + c1) == ZERO
    return HALF * (top + bottom) if better else c0, ZERO if better else c1, flat_e if better else e


@lane
def absolute(a0, a1, ea):
    """Enclosure of |a|: |a| - s a lies in [0, max((1 - s) high, -(1 + s) low)] for any s of [-1, 1]."""
    reach = (abs(a1) + ea) * GROW
    s = TWO * clamped(HALF + HALF * a0 / (reach + TINY)) - ONE
    high = (a0 + reach) * (ONE - s)
    low = (reach - a0) * (ONE + s)
    gap = HALF * (high if high > low else low)
    gap = gap if gap > ZERO else ZERO
    e = (abs(s) * ea + gap) * GROW
    return s * a0 + gap, s * a1, e if abs(s) == ONE else e + PAD * (abs(a0) + abs(a1))


@lane
def reciprocal(a0, a1, ea):
    """Enclosure of 1/a where a keeps one sign: midway between the chord and the tangent parallel to it."""
    reach = (abs(a1) + ea) * GROW + PAD * abs(a0)
    near = abs(a0) - reach
    far = abs(a0) + reach
    safe = near if near > LEAST else LEAST
    p = ONE / safe
    q = ONE / far
    middle = np.sqrt(p * q)
    slope = -(p * q)
    c0 = HALF * (p + q) + middle
    gap = HALF * (p + q) - middle
    c0 = -c0 if a0 < ZERO else c0
    e = (gap - slope * ea) * GROW + F(8.0) * PAD * p
    return c0 + slope * a0, slope * a1, e if near > LEAST and far < FAR else INFINITE


@lane
def square_root(a0, a1, ea):
    """Enclosure of sqrt(a) where a >= 0: midway between the chord and the tangent parallel to it."""
    reach = (abs(a1) + ea) * GROW
    low = a0 - reach - PAD * abs(a0)
    high = a0 + reach + PAD * abs(a0)
    q = np.sqrt(high if high > ZERO else ZERO * high)
    p = np.sqrt(low if low > LEAST else LEAST)
    slope = ONE / (p + q)
    gap = F(0.125) * (q - p) * (q - p) * slope
    e = (slope * ea + gap) * GROW + F(8.0) * PAD * q
    flat = not (low > LEAST)
    return (
        HALF * q if flat else p * q * slope + gap + slope * a0,
        ZERO if flat else slope * a1,
        HALF * q * GROW + PAD * q + TINY if flat else e,
    )


@lane
def curve(f, slope, least, most, a1, ea):
    """Taylor enclosure of a function of a with value and slope at a0, its second derivative in least..most."""
    reach = (abs(a1) + ea) * GROW
    low = QUARTER * (least if least < ZERO else ZERO) * reach * reach
    high = QUARTER * (most if most > ZERO else ZERO) * reach * reach
    e = (high - low + abs(slope) * ea) * GROW
    return f + low + high, slope * a1, e + PAD * (abs(f) + abs(slope * a1))


@lane
def wave(s, c, a0, a1, ea):
    """Enclosure of the sine about a0, given its sine s and cosine c; [-1, 1] where that is narrower."""
    reach = (abs(a1) + ea) * GROW
    least = -s - reach - single.WAVE_ERROR
    most = reach - s + single.WAVE_ERROR
    least = least if least > -ONE else -ONE
    most = most if most < ONE else ONE
    c0, c1, e = curve(s, c, least, most, a1, ea)
    e += single.WAVE_ERROR * (TWO + reach)
    fine = reach < WAVES and e < ONE and abs(a0) < single.FARTHEST
    unknown = ZERO * (a0 + reach)  # 0, or NaN where that is not finite
    return c0 if fine else unknown, c1 if fine else ZERO, e if fine else ONE + PAD


@lane
def grown(a0, a1, ea):
    """Enclosure of exp(a); nothing is claimed where float32 overflows."""
    reach = (abs(a1) + ea) * GROW + PAD * abs(a0)
    reach = reach if reach >= ZERO else INFINITE
    f = single.exponential(a0)
    most = single.exponential(a0 + reach) * (ONE + single.EXP_ERROR)
    least = single.exponential(a0 - reach) * (ONE - single.EXP_ERROR)
    least = least if a0 - reach > F(-86.0) else ZERO
    c0, c1, e = curve(f, f, least, most, a1, ea)
    e += single.EXP_ERROR * f * (TWO + reach) + TINY
    flat = not (reach < ONE and a0 > F(-80.0))
    e = HALF * (most - least) * GROW + PAD * most + TINY if flat else e
    return HALF * (most + least) if flat else c0, ZERO if flat else c1, e if a0 + reach < F(87.0) else INFINITE


@lane
def logged(a0, a1, ea):
    """Enclosure of log(a) where a > 0; infinite where a may reach 0."""
    reach = (abs(a1) + ea) * GROW + PAD * abs(a0)
    low = a0 - reach
    high = a0 + reach
    safe = low if low > LEAST else LEAST
    top = high if high > LEAST else LEAST
    f = single.logarithm(a0 if a0 > LEAST else LEAST)
    slope = ONE / a0
    ratio = reach / safe  # divided before squared, since 1/a^2 may underflow
    sag = QUARTER * ratio * ratio
    c0 = f - sag
    c1 = slope * a1
    e = (sag + abs(slope) * ea) * GROW + LOG_ERROR * (ONE + abs(f)) + PAD * (abs(f) + sag + (abs(a1) + ea) / safe)
    bottom = single.logarithm(safe)
    top = single.logarithm(top)
    flat_e = HALF * (top - bottom) * GROW + (LOG_ERROR + PAD) * (ONE + abs(top) + abs(bottom))
    flat = not (e < flat_e)
    e = flat_e if flat else e
    return (
        HALF * (top + bottom) if flat else c0,
        ZERO if flat else c1,
        e if low > LEAST and high < F(1.0e37) else INFINITE,
    )


@lane
def fraction(b0, b1, eb):
    """Whether an exponent is proved to be a constant that is no integer."""
    low, high = b0 - GROW * eb, b0 + GROW * eb
    return b1 == ZERO and single.below(low) == single.below(high) and low != single.below(low)


@lane
def power(a0, a1, ea, b0, b1, eb):
    """Enclosure of a^b: exp(b log a) where a > 0; elsewhere a hull for a constant exponent > 0 that is no integer."""
    reach = (abs(a1) + ea) * GROW + PAD * abs(a0)
    high = a0 + reach
    l0, l1, el = logged(a0, a1, ea)
    p0, p1, ep = product(b0, b1, eb, l0, l1, el)
    c0, c1, e = grown(p0, p1, ep)
    m0, m1, em = logged(high if high > F(2.0) * LEAST else F(2.0) * LEAST, ZERO, ZERO)
    p0, p1, ep = product(b0, ZERO, eb, m0, m1, em)
    m0, m1, em = grown(p0, p1, ep)
    flat = not (a0 - reach > LEAST)
    top = m0 + em
    top = top if fraction(b0, b1, eb) and b0 > ZERO and high == high else INFINITE
    return HALF * top if flat else c0, ZERO if flat else c1, HALF * top * GROW + TINY if flat else e


@lane
def turned(y0, y1, ey, x0, x1, ex):
    """Enclosure of atan2(y, x): Taylor with the second derivatives bounded by 1/r^2 of the nearest point.

    Where the rectangle of arguments meets the cut x <= 0, y = 0 it is [-pi, pi].
    """
    reach_x = (abs(x1) + ex) * GROW + PAD * abs(x0)
    reach_y = (abs(y1) + ey) * GROW + PAD * abs(y0)
    near_x = abs(x0) - reach_x
    near_y = abs(y0) - reach_y
    near_x = near_x if near_x > ZERO else ZERO
    near_y = near_y if near_y > ZERO else ZERO
    r2 = x0 * x0 + y0 * y0
    near2 = near_x * near_x + near_y * near_y
    r2 = r2 if r2 > LEAST else LEAST
    to_y = x0 / r2
    to_x = -y0 / r2
    remainder = HALF * (reach_x * reach_x + reach_y * reach_y) / (near2 if near2 > LEAST else LEAST)
    e = (abs(to_y) * ey + abs(to_x) * ex + remainder) * GROW
    e += single.WAVE_ERROR + PAD * (F(4.0) + abs(to_y * y1) + abs(to_x * x1))
    fine = (near_y > ZERO or x0 - reach_x > ZERO) and near2 > LEAST and e < PI
    unknown = ZERO * (reach_x + reach_y + abs(x0) + abs(y0))
    return (
        single.angle(y0, x0) if fine else unknown,
        to_y * y1 + to_x * x1 if fine else ZERO,
        e if fine else PI + F(4.0) * PAD,
    )


@lane
def floored(a0, a1, ea):
    """Enclosure of floor(a), its hull."""
    reach = (abs(a1) + ea) * GROW
    reach = reach + PAD * abs(a0) if reach > ZERO else reach
    low = single.below(a0 - reach)
    high = single.below(a0 + reach)
    fine = abs(low) < single.WHOLE_NUMBERS and abs(high) < single.WHOLE_NUMBERS
    return HALF * (low + high) + ZERO * (a0 + reach), ZERO, HALF * (high - low) * GROW if fine else INFINITE


@lane
def signed(a0, a1, ea):
    """Enclosure of the sign of a, its hull."""
    reach = (abs(a1) + ea) * GROW
    reach = reach + PAD * abs(a0) if reach > ZERO else reach
    low = a0 - reach
    high = a0 + reach
    low = -ONE if low < ZERO else (ONE if low > ZERO else ZERO * low)
    high = ONE if high > ZERO else (-ONE if high < ZERO else ZERO * high)
    return HALF * (low + high) + ZERO * reach, ZERO, HALF * (high - low) * GROW
