# mypy: ignore-errors
"""Interval bounds of a tape over a box, rounded outward, to cull boxes without surface.

A bound may be infinite, after overflow or at a pole: the operations after it still enclose.
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.enclose.forms_kernels import never_negative
from sceneql.field.enclose.sine_kernels import sine_cosine
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.order_kernels import sign_of

LARGE = 1.0e300
ULPS = 1.2e-15
"""Five units in the last place: more than the error of any library function."""
TINY = 1.0e-300
TURN = 2.0 * np.pi
OF_PARTS = types.UniTuple(types.float64, 2)(
    types.float64[:, ::1], types.int64, types.int64, types.float64[:, ::1], types.int64
)
density_box = lazy("sceneql.field.skeleton.parts_box_kernels:density_box", OF_PARTS)
skeleton_box = lazy("sceneql.field.skeleton.parts_box_kernels:skeleton_box", OF_PARTS)


@inlined
def outward(low, high):
    """The interval widened outward by its rounding; infinite bounds stay."""
    down = min(low * (1.0 - ULPS), low * (1.0 + ULPS))
    up = max(high * (1.0 - ULPS), high * (1.0 + ULPS))
    return down - TINY, up + TINY


@inlined
def hull4(p, q, r, s):
    """Least interval that contains four numbers."""
    return outward(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)))


@inlined
def products(a, b, c, d):
    """Interval of [a, b] [c, d]; zero times an infinite bound is zero, since the values themselves are finite.

    Of exactly zero the product is exactly that: so is a branch of `where` that is not taken.
    """
    if (a == 0.0 and b == 0.0) or (c == 0.0 and d == 0.0):
        return 0.0, 0.0
    p = a * c
    q = a * d
    r = b * c
    s = b * d
    if np.isnan(p + q + r + s):
        p = 0.0 if a == 0.0 or c == 0.0 else p
        q = 0.0 if a == 0.0 or d == 0.0 else q
        r = 0.0 if b == 0.0 or c == 0.0 else r
        s = 0.0 if b == 0.0 or d == 0.0 else s
    return hull4(p, q, r, s)


@inlined
def quotients(a, b, c, d):
    """Interval of [a, b] / [c, d] with a divisor of one sign; a finite number over an infinite bound is zero."""
    p = a / c
    q = a / d
    r = b / c
    s = b / d
    if np.isnan(p + q + r + s):
        p = 0.0 if abs(c) == np.inf else p
        q = 0.0 if abs(d) == np.inf else q
        r = 0.0 if abs(c) == np.inf else r
        s = 0.0 if abs(d) == np.inf else s
    return hull4(p, q, r, s)


@inlined
def over_zero(a, b, d):
    """Interval of [a, b] / [0, d], undefined where the divisor is zero."""
    if a >= 0.0:
        return outward(a / d, np.inf)
    return outward(-np.inf, b / d if b <= 0.0 else np.inf)


@inlined
def few_digits(a):
    """Whether a number has at most 24 binary digits, as whole numbers below 2^24: products of two such are exact."""
    return a == np.float64(np.float32(a))


@inlined
def exact(op, a, c):
    """Whether a + c, a - c or a c is free of rounding, as with the whole numbers that steps give."""
    if op == ops.MUL:
        return few_digits(a) and few_digits(c) and (a == 0.0 or c == 0.0 or abs(a * c) > TINY)
    c = -c if op == ops.SUB else c
    total = a + c
    part = total - a  # the error of a sum, exactly (Knuth 1969)
    return (a - (total - part)) + (c - part) == 0.0


@inlined
def squared(low, high):
    """Interval of the square."""
    p = low * low
    q = high * high
    return 0.0 if low <= 0.0 <= high else min(p, q), max(p, q)


@inlined
def wave(low, high, peak):
    """Interval of the cosine of a - peak."""
    if high - low >= TURN or abs(low) > 1.0e6 or abs(high) > 1.0e6:
        return -1.0, 1.0
    first = sine_cosine(low - peak)[1]
    second = sine_cosine(high - peak)[1]
    bottom = min(first, second) - ULPS
    top = max(first, second) + ULPS
    # Whether the interval, widened by a hair, contains a peak or a trough.
    hair = 1.0e-9
    if np.floor((high - peak) / TURN + hair) >= np.ceil((low - peak) / TURN - hair):
        top = 1.0
    if np.floor((high - peak) / TURN - 0.5 + hair) >= np.ceil((low - peak) / TURN - 0.5 - hair):
        bottom = -1.0
    return max(bottom, -1.0), min(top, 1.0)


@inlined
def binary_box(op, a, b, c, d):
    """(low, high, status) of an operation on [a, b] and [c, d]."""
    if a == b and c == d and (op == ops.ADD or op == ops.SUB or op == ops.MUL) and exact(op, a, c):
        low = a + c if op == ops.ADD else (a - c if op == ops.SUB else a * c)
        high = low
    elif op == ops.ADD:
        low, high = outward(a + c, b + d)
        if a >= 0.0 and c >= 0.0:
            low = max(low, 0.0)  # so that a sum of squares has a square root
    elif op == ops.SUB:
        low, high = outward(a - d, b - c)
    elif op == ops.MUL:
        low, high = products(a, b, c, d)
    elif op == ops.MIN:
        return min(a, c), min(b, d), ops.WHOLE
    elif op == ops.MAX:
        return max(a, c), max(b, d), ops.WHOLE
    elif op == ops.DIV:
        if c <= 0.0 <= d:
            return -np.inf, np.inf, ops.PARTIAL
        low, high = quotients(a, b, c, d)
    elif op == ops.POW:
        if c < d:  # a varying exponent is a whole number: the builder lowers all others
            c, d = np.ceil(c), np.floor(d)
        if a > 0.0:
            low, high = hull4(a**c, a**d, b**c, b**d)
        elif c == d and c > 0.0 and c != np.floor(c):
            if b < 0.0:
                return 0.0, 0.0, ops.NOWHERE
            low, high = outward(0.0, b**c)
            return max(low, 0.0), high, ops.PARTIAL if a < 0.0 else ops.WHOLE
        elif c == d == np.floor(c) and (c >= 0.0 or b < 0.0):
            low, high = hull4(a**c, a**c, b**c, b**c)
            if c > 0.0 and 0.5 * c == np.floor(0.5 * c):
                low = 0.0 if b >= 0.0 else max(low, 0.0)
        elif a == 0.0 and c >= 0.0:
            low, high = outward(0.0, max(1.0, max(b**c, b**d)))
            return 0.0, high, ops.WHOLE
        else:
            return -np.inf, np.inf, ops.PARTIAL
    elif c <= 0.0 and a <= 0.0 <= b:
        low, high = outward(-np.pi, np.pi)
    else:
        low, high = hull4(np.arctan2(a, c), np.arctan2(a, d), np.arctan2(b, c), np.arctan2(b, d))
    return low, high, ops.WHOLE


@inlined
def unary_box(op, a, b):
    """(low, high, status) of an operation on [a, b]."""
    status = ops.WHOLE
    if op == ops.NEG:
        low, high = -b, -a
    elif op == ops.ABS:
        low = 0.0 if a <= 0.0 <= b else min(abs(a), abs(b))
        high = max(abs(a), abs(b))
    elif op == ops.SQUARE:
        low, high = squared(a, b)
        if not (a == b and exact(ops.MUL, a, a)):
            low, high = outward(low, high)
        low = max(low, 0.0)
    elif op == ops.SQRT:
        if b < 0.0:
            return 0.0, 0.0, ops.NOWHERE
        status = ops.WHOLE if a >= 0.0 else ops.PARTIAL
        low, high = outward(np.sqrt(max(a, 0.0)), np.sqrt(b))
        low = max(low, 0.0)
    elif op == ops.SIN:
        low, high = wave(a, b, 0.25 * TURN)
    elif op == ops.COS:
        low, high = wave(a, b, 0.0)
    elif op == ops.EXP:
        low, high = outward(np.exp(a), np.exp(b))
        low = max(low, 0.0)
    elif op == ops.LOG:
        if b < 0.0:
            return 0.0, 0.0, ops.NOWHERE
        status = ops.WHOLE if a > 0.0 else ops.PARTIAL
        low, high = outward(np.log(a) if a > 0.0 else -np.inf, np.log(b))
    elif op == ops.FLOOR:
        low, high = np.floor(a), np.floor(b)
    elif op == ops.COPY:
        low, high = a, b
    else:
        low, high = sign_of(a), sign_of(b)
    return low, high, status


@inlined
def over_cut(code, scratch, k):
    """Whether the arguments of row k, an angle free up to whole turns, meet its cut y = 0 > x."""
    y = code[k, 1]
    return code[k, 3] != 0 and scratch[code[k, 2], 1] < 0.0 and scratch[y, 0] <= 0.0 <= scratch[y, 1]


@inlined
def finite(scratch, k):
    """Whether both bounds of a row are finite."""
    return scratch[k, 0] > -LARGE and scratch[k, 1] < LARGE


@inlined
def positive_or_zero(op):
    """Whether a lower bound zero of an operation is always +0, so that its reciprocal is +infinity."""
    return never_negative(op) or op == ops.ADD


@kernel(
    f"Tuple((float64, float64, int64))({ops.TAPE}, float64, float64, float64, float64, float64, float64)", _nrt=False
)
def box(code, constants, parts, scratch, x0, x1, y0, y1, z0, z1):
    """(low, high, status): f lies in low..high wherever it is defined in the box; ``scratch`` (rows, 8) is overwritten.

    So do all rows in theirs, but angles that are free up to whole turns may go on beyond pi.

    ``status`` says WHOLE (defined all over), PARTIAL (perhaps not, or too large for float64) or NOWHERE. Where no bound
    is known, as for a box with NaN or low > high, the answer is (-inf, inf, PARTIAL).
    """
    last = code.shape[0] - 1
    status = ops.WHOLE
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        found = ops.WHOLE
        if op == ops.CONSTANT:
            low = high = constants[left]
        elif op == ops.X:
            low = x0
            high = x1
        elif op == ops.Y:
            low = y0
            high = y1
        elif op == ops.Z:
            low = z0
            high = z1
        elif op == ops.DENSITY or op == ops.SKELETON:
            p = code[k, 3]
            if finite(scratch, p) and finite(scratch, p + 1) and finite(scratch, p + 2):
                if op == ops.DENSITY:
                    low, high = density_box(parts, left, right, scratch, p)
                else:
                    low, high = skeleton_box(parts, left, right, scratch, p)
            else:
                low = -np.inf
                high = np.inf
        elif op == ops.DIV and scratch[right, 0] == 0.0 < scratch[right, 1] and positive_or_zero(code[right, 0]):
            low, high = over_zero(scratch[left, 0], scratch[left, 1], scratch[right, 1])
            found = ops.PARTIAL
        elif op == ops.ATAN2 and over_cut(code, scratch, k):
            # atan2(y, x) = pi - atan2(y, -x), or a whole turn less
            low, high, _ = binary_box(op, scratch[left, 0], scratch[left, 1], -scratch[right, 1], -scratch[right, 0])
            low, high = outward(np.pi - high, np.pi - low)
        elif op <= ops.ATAN2 and op != ops.COPY:
            low, high, found = binary_box(op, scratch[left, 0], scratch[left, 1], scratch[right, 0], scratch[right, 1])
        else:
            low, high, found = unary_box(op, scratch[left, 0], scratch[left, 1])
        if found == ops.NOWHERE:
            return np.inf, -np.inf, ops.NOWHERE
        status = max(status, found)
        if not low <= high:
            return -np.inf, np.inf, ops.PARTIAL
        if low <= -LARGE or high >= LARGE:
            status = max(status, ops.PARTIAL)
            low = min(low, LARGE)
            high = max(high, -LARGE)
        scratch[k, 0] = low
        scratch[k, 1] = high
    return low, high, status
