# mypy: ignore-errors
"""First-order Taylor (affine) enclosures of a tape along a ray segment.

On the segment o + t d, t = tm + h tau with tau in [-1, 1], every register is enclosed as c0 + c1 tau +- e (columns 0-2
of its row of scratch), as in the affine arithmetic of Comba & Stolfi (1993) with one symbol kept: e shrinks with h^2,
so that cutting the segment where the enclosure has no zero converges quadratically. Rounding is covered by widening e
by some units in the last place of all magnitudes added, and by some of its own.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, kernel
from sceneql.field.enclose import forms_kernels as forms
from sceneql.field.enclose.sine_kernels import sine_cosine
from sceneql.field.skeleton.density_enclosure_kernels import density_segment
from sceneql.field.skeleton.skeleton_enclosure_kernels import skeleton_segment
from sceneql.field.tape import tape_ops as ops

FAR = 1.0e150
NEAR = 1.0e-300
"""Largest magnitude, and least square, with a useful slope: beyond these it would be lost to underflow."""


@inlined
def reciprocal(a0, a1, ea):
    """Enclosure of 1/a where a keeps one sign: midway between the chord and the tangent parallel to it."""
    reach = forms.spread(a0, a1, ea)
    near = abs(a0) - reach
    far = abs(a0) + reach
    if not (near > 0.0 and far < FAR):
        return 0.0, 0.0, np.inf
    slope = -1.0 / near / far
    p = np.sqrt(1.0 / near)
    q = np.sqrt(1.0 / far)
    c0 = 0.5 * (p + q) * (p + q)
    if a0 < 0.0:
        c0 = -c0
    e = 0.5 * (p - q) * (p - q) - slope * ea
    return c0 + slope * a0, slope * a1, e + forms.PAD * (abs(c0) + p * p)


@inlined
def square_root(a0, a1, ea):
    """Enclosure of sqrt(a) where a >= 0: midway between the chord and the tangent parallel to it."""
    reach = forms.spread(a0, a1, ea)
    high = a0 + reach
    if not high > 0.0:
        return 0.0, 0.0, 0.0
    low = max(a0 - reach, 0.0)
    p = np.sqrt(low)
    q = np.sqrt(high)
    slope = 1.0 / (p + q)
    half_gap = 0.125 * (q - p) * (q - p) * slope
    if a0 - reach < 0.0:
        return forms.hull(0.0, q)
    return p * q * slope + half_gap + slope * a0, slope * a1, slope * ea + half_gap + forms.PAD * q * 2.0


@inlined
def curve(f, slope, least, most, a1, ea):
    """Taylor enclosure of a function of a with value and slope at a0, its second derivative in least..most."""
    reach = abs(a1) + ea
    low = 0.25 * min(least, 0.0) * reach * reach
    high = 0.25 * max(most, 0.0) * reach * reach
    e = high - low + abs(slope) * ea
    return f + low + high, slope * a1, e + forms.PAD * (abs(f) + abs(slope * a1))


@inlined
def sine(s, c, a1, ea):
    """Enclosure of the sine about an argument with sine s and cosine c; [-1, 1] where that is narrower."""
    reach = abs(a1) + ea
    if reach < 1.5:
        c0, c1, e = curve(s, c, max(-s - reach, -1.0), min(reach - s, 1.0), a1, ea)
        if e < 1.0:
            return c0, c1, e + forms.PAD
    return 0.0, 0.0, 1.0 + forms.PAD


@inlined
def exponential(a0, a1, ea):
    """Enclosure of exp(a)."""
    reach = forms.spread(a0, a1, ea)
    low = np.exp(a0 - reach)
    high = np.exp(a0 + reach)
    if reach > 1.0:
        return forms.hull(low, high)
    f = np.exp(a0)
    return curve(f, f, low, high, a1, ea)


@inlined
def logarithm(a0, a1, ea):
    """Enclosure of log(a) where a > 0; infinite where a may reach 0."""
    reach = forms.spread(a0, a1, ea)
    low = a0 - reach
    if not low > 0.0:
        return 0.0, 0.0, np.inf
    if reach > low:
        return forms.hull(np.log(low), np.log(a0 + reach))
    f = np.log(a0)
    slope = 1.0 / a0
    # The second derivative is -1/a^2; a^2 alone may overflow.
    gap = 0.25 * (reach / low) * (reach / low)
    return f - gap, slope * a1, gap + slope * ea + forms.PAD * (abs(f) + abs(slope * a1))


@inlined
def power(a0, a1, ea, b0, b1, eb):
    """Enclosure of a^b: exp(b log a) where a > 0; elsewhere a hull for a constant exponent > 0 that is no integer."""
    reach = forms.spread(a0, a1, ea)
    if a0 > reach:
        l0, l1, el = logarithm(a0, a1, ea)
        p0, p1, ep = forms.product(b0, b1, eb, l0, l1, el)
        return exponential(p0, p1, ep)
    if b1 == 0.0 and eb == 0.0 and b0 > 0.0 and b0 != np.floor(b0):
        return forms.hull(0.0, (a0 + reach) ** b0)
    return 0.0, 0.0, np.inf


@inlined
def angle(y0, y1, ey, x0, x1, ex):
    """Enclosure of atan2(y, x): Taylor with the second derivatives bounded by 1/r^2 of the nearest point.

    Where the rectangle of arguments meets the cut x <= 0, y = 0 it is [-pi, pi].
    """
    reach_x = forms.spread(x0, x1, ex)
    reach_y = forms.spread(y0, y1, ey)
    near_x = max(abs(x0) - reach_x, 0.0)
    near_y = max(abs(y0) - reach_y, 0.0)
    if near_y == 0.0 and x0 - reach_x <= 0.0:
        return 0.0, 0.0, np.pi + forms.PAD * 4.0
    r2 = x0 * x0 + y0 * y0
    if not NEAR < r2 < forms.LARGE:
        return 0.0, 0.0, np.pi + forms.PAD * 4.0
    to_y = x0 / r2
    to_x = -y0 / r2
    remainder = 0.5 * (reach_x * reach_x + reach_y * reach_y) / (near_x * near_x + near_y * near_y)
    if remainder > np.pi:
        return 0.0, 0.0, np.pi + forms.PAD * 4.0
    e = abs(to_y) * ey + abs(to_x) * ex + remainder
    return np.arctan2(y0, x0), to_y * y1 + to_x * x1, e + forms.PAD * (4.0 + abs(to_y * y1) + abs(to_x * x1))


@inlined
def binary(op, a0, a1, ea, b0, b1, eb):
    """Enclosure of the rarer or longer operations of two arguments."""
    if op == ops.DIV:
        r0, r1, er = reciprocal(b0, b1, eb)
        return forms.product(a0, a1, ea, r0, r1, er)
    if op == ops.MAX:
        return forms.larger_of(a0, a1, ea, b0, b1, eb)
    if op == ops.MIN:
        m0, m1, em = forms.larger_of(-a0, -a1, ea, -b0, -b1, eb)
        return -m0, -m1, em
    if op == ops.POW:
        return power(a0, a1, ea, b0, b1, eb)
    return angle(a0, a1, ea, b0, b1, eb)


@inlined
def unary(op, a0, a1, ea):
    """Enclosure of the rarer or longer operations of one argument."""
    if op == ops.SQRT:
        return square_root(a0, a1, ea)
    if op == ops.EXP:
        return exponential(a0, a1, ea)
    if op == ops.LOG:
        return logarithm(a0, a1, ea)
    reach = forms.spread(a0, a1, ea)
    low = a0 - reach
    high = a0 + reach
    if op == ops.ABS:
        if low >= 0.0:
            return a0, a1, ea
        if high <= 0.0:
            return -a0, -a1, ea
        slope = a0 / reach
        half_gap = -0.5 * low * (high / reach)
        return slope * a0 + half_gap, slope * a1, abs(slope) * ea + half_gap + forms.PAD * reach
    if op == ops.FLOOR:
        return forms.hull(np.floor(low), np.floor(high))
    return forms.hull(
        -1.0 if low < 0.0 else (1.0 if low > 0.0 else 0.0), 1.0 if high > 0.0 else (-1.0 if high < 0.0 else 0.0)
    )


@inlined
def domain(op, positive, a0, reach_a, b0, reach_b, b_constant):
    """Status of an operation by the ranges of its arguments: WHOLE, PARTIAL or NOWHERE.

    ``positive``: the first argument is never below 0.
    """
    if op == ops.SQRT:
        return ops.WHOLE if positive or a0 >= reach_a else (ops.NOWHERE if a0 + reach_a < 0.0 else ops.PARTIAL)
    if op == ops.LOG:
        return ops.WHOLE if a0 > reach_a else (ops.NOWHERE if a0 + reach_a < 0.0 else ops.PARTIAL)
    if op == ops.DIV:
        return ops.WHOLE if abs(b0) > reach_b else ops.PARTIAL
    if op == ops.POW:
        if a0 > reach_a or (positive and b_constant and b0 > 0.0):
            return ops.WHOLE
        return ops.NOWHERE if a0 + reach_a < 0.0 and b_constant and b0 != np.floor(b0) else ops.PARTIAL
    return ops.WHOLE


@kernel(
    f"Tuple((float64, float64, float64, int64))({ops.TAPE}, float64, float64, float64, float64, float64, float64,"
    " float64, float64, boolean)",
    _nrt=False,
)
def segment(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, survey):
    """(c0, c1, e, status) of f on the segment o + t d, t in [t0, t1]; ``scratch`` (rows, 8) is overwritten.

    Wherever f is defined there, it lies in c0 + c1 tau +- e, t = (t0 + t1)/2 + tau (t1 - t0)/2. ``status`` says WHOLE
    (defined all over), PARTIAL (perhaps not) or NOWHERE; e is infinite where no bound is known. With ``survey`` the
    parts of density fields within reach of the segment are listed in scratch; a call without it must be for a piece of
    the segment last surveyed.
    """
    middle = 0.5 * (t0 + t1)
    half = 0.5 * (t1 - t0) + 2.0e-16 * (abs(t0) + abs(t1))
    last = code.shape[0] - 1
    status = ops.WHOLE
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        a0 = scratch[left, 0]
        a1 = scratch[left, 1]
        ea = scratch[left, 2]
        b0 = scratch[right, 0]
        b1 = scratch[right, 1]
        eb = scratch[right, 2]
        if op == ops.MUL:
            c0, c1, e = forms.product(a0, a1, ea, b0, b1, eb)
        elif op == ops.ADD:
            c0 = a0 + b0
            c1 = a1 + b1
            e = ea + eb + forms.PAD * (abs(c0) + abs(c1))
        elif op == ops.SUB:
            c0 = a0 - b0
            c1 = a1 - b1
            e = ea + eb + forms.PAD * (abs(c0) + abs(c1))
        elif op == ops.SQUARE:
            second = 0.5 * a1 * a1
            size = abs(a0) + abs(a1)
            c0 = a0 * a0 + second
            c1 = 2.0 * a0 * a1
            e = second + ea * (2.0 * size + ea) + (forms.PAD * size * size + forms.TINY)
        elif op == ops.CONSTANT:
            c0 = constants[left]
            c1 = e = 0.0
        elif op == ops.X or op == ops.Y or op == ops.Z:
            o = ox if op == ops.X else (oy if op == ops.Y else oz)
            d = dx if op == ops.X else (dy if op == ops.Y else dz)
            c0 = o + middle * d
            c1 = half * d
            e = forms.PAD * (abs(o) + abs(middle * d) + abs(c1))
        elif op == ops.COPY:
            c0 = a0
            c1 = a1
            e = ea
        elif op == ops.NEG:
            c0 = -a0
            c1 = -a1
            e = ea
        elif op == ops.DENSITY:
            c0, c1, e = density_segment(parts, left, right, scratch, k, last + 1 + left, code[k, 3], survey)
        elif op == ops.SKELETON:
            c0, c1, e = skeleton_segment(parts, left, right, scratch, k, last + 1 + left, code[k, 3], survey)
        elif op == ops.SIN or op == ops.COS:
            twin = code[k, 3]
            if twin:
                s = scratch[twin, 3]
                c = scratch[twin, 4]
            else:
                s, c = sine_cosine(a0)
                scratch[k, 3] = s
                scratch[k, 4] = c
            if op == ops.COS:
                s, c = c, -s
            c0, c1, e = sine(s, c, a1, ea)
        elif op <= ops.ATAN2:
            positive = forms.never_negative(code[left, 0])
            found = domain(op, positive, a0, abs(a1) + ea, b0, abs(b1) + eb, b1 == 0.0 and eb == 0.0)
            if found == ops.NOWHERE:
                return 0.0, 0.0, np.inf, ops.NOWHERE
            status = max(status, found)
            c0, c1, e = binary(op, a0, a1, ea, b0, b1, eb)
            e += forms.TINY
        else:
            found = domain(op, forms.never_negative(code[left, 0]), a0, abs(a1) + ea, 0.0, 0.0, False)
            if found == ops.NOWHERE:
                return 0.0, 0.0, np.inf, ops.NOWHERE
            status = max(status, found)
            c0, c1, e = unary(op, a0, a1, ea)
            e += forms.TINY
        e *= forms.WIDER
        if not e + abs(c0) + abs(c1) < forms.LARGE:
            return 0.0, 0.0, np.inf, ops.PARTIAL
        scratch[k, 0] = c0
        scratch[k, 1] = c1
        scratch[k, 2] = e
    return c0, c1, e, status
