# mypy: ignore-errors
"""Interval bounds of a tape over a box, rounded outward, to cull what a solid cannot reach."""

import numpy as np

from sceneql.field.density_kernels import offset
from sceneql.field.sine_kernels import sine_cosine
from sceneql.field.skeleton_bounds_kernels import skeleton_box
from sceneql.field.tape_kernels import TAPE, sign_of
from sceneql.field.tape_ops import (
    ABS,
    ADD,
    ATAN2,
    CONSTANT,
    COPY,
    COS,
    DENSITY,
    DIV,
    EXP,
    FLOOR,
    LOG,
    MAX,
    MIN,
    MUL,
    NEG,
    NOWHERE,
    PARTIAL,
    POW,
    SIN,
    SKELETON,
    SQRT,
    SQUARE,
    SUB,
    WHOLE,
    X,
    Y,
    Z,
)
from sceneql.kernels import inlined, kernel

LARGE = 1.0e300
ULPS = 1.2e-15
"""Five units in the last place: more than any library function is off."""
TINY = 1.0e-300
TURN = 2.0 * np.pi


@inlined
def outward(low, high):
    """The interval widened by its rounding."""
    return low - ULPS * abs(low) - TINY, high + ULPS * abs(high) + TINY


@inlined
def hull4(p, q, r, s):
    """Least interval with four numbers."""
    return outward(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)))


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
    # Whole turns from the peak, and from the trough, that lie within the interval or a hair outside.
    hair = 1.0e-9
    if np.floor((high - peak) / TURN + hair) >= np.ceil((low - peak) / TURN - hair):
        top = 1.0
    if np.floor((high - peak) / TURN - 0.5 + hair) >= np.ceil((low - peak) / TURN - 0.5 - hair):
        bottom = -1.0
    return max(bottom, -1.0), min(top, 1.0)


@inlined
def density_box(parts, start, stop, scratch, p):
    """Interval of a density field over the box whose sides are rows p..p+2 of scratch."""
    low = high = bulk = 0.0
    hx = 0.5 * (scratch[p, 1] - scratch[p, 0])
    hy = 0.5 * (scratch[p + 1, 1] - scratch[p + 1, 0])
    hz = 0.5 * (scratch[p + 2, 1] - scratch[p + 2, 0])
    x = scratch[p, 0] + hx
    y = scratch[p + 1, 0] + hy
    z = scratch[p + 2, 0] + hz
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    for i in range(start, stop):
        wx, wy, wz = offset(parts, i, x, y, z)
        radius = parts[i, 6]
        weight = parts[i, 7]
        # The distance changes no faster than the point moves.
        distance = np.sqrt(wx * wx + wy * wy + wz * wz)
        blur = ULPS * (distance + diagonal + abs(x) + abs(y) + abs(z) + abs(parts[i, 0] - parts[i, 3]))
        blur += ULPS * (abs(parts[i, 1] - parts[i, 4]) + abs(parts[i, 2] - parts[i, 5]))
        near = max(distance - diagonal - blur, 0.0)
        far = distance + diagonal + blur
        if parts[i, 0] == parts[i, 3] and parts[i, 1] == parts[i, 4] and parts[i, 2] == parts[i, 5]:
            nx = max(abs(wx) - hx - blur, 0.0)
            ny = max(abs(wy) - hy - blur, 0.0)
            nz = max(abs(wz) - hz - blur, 0.0)
            near = np.sqrt(nx * nx + ny * ny + nz * nz) - blur
        least = 1.0 - far * far / (radius * radius)
        most = 1.0 - near * abs(near) / (radius * radius)
        least = least * least * least if least > 0.0 else 0.0
        most = most * most * most if most > 0.0 else 0.0
        low += weight * (least if weight > 0.0 else most)
        high += weight * (most if weight > 0.0 else least)
        bulk += abs(weight) * most
    return low - ULPS * 8.0 * bulk, high + ULPS * 8.0 * bulk


@inlined
def binary_box(op, a, b, c, d):
    """(low, high, status) of an operation on [a, b] and [c, d]."""
    if op == ADD:
        low, high = outward(a + c, b + d)
        if a >= 0.0 and c >= 0.0:
            low = max(low, 0.0)  # so that a sum of squares has a square root
    elif op == SUB:
        low, high = outward(a - d, b - c)
    elif op == MUL:
        low, high = hull4(a * c, a * d, b * c, b * d)
    elif op == MIN:
        return min(a, c), min(b, d), WHOLE
    elif op == MAX:
        return max(a, c), max(b, d), WHOLE
    elif op == DIV:
        if c <= 0.0 <= d:
            return -np.inf, np.inf, PARTIAL
        low, high = hull4(a / c, a / d, b / c, b / d)
    elif op == POW:
        if a > 0.0:
            low, high = hull4(a**c, a**d, b**c, b**d)
        elif c == d and c > 0.0 and c != np.floor(c):
            if b < 0.0:
                return 0.0, 0.0, NOWHERE
            low, high = outward(0.0, b**c)
            return max(low, 0.0), high, PARTIAL if a < 0.0 else WHOLE
        else:
            return -np.inf, np.inf, PARTIAL
    elif c <= 0.0 and a <= 0.0 <= b:
        low, high = outward(-np.pi, np.pi)
    else:
        low, high = hull4(np.arctan2(a, c), np.arctan2(a, d), np.arctan2(b, c), np.arctan2(b, d))
    return low, high, WHOLE


@inlined
def unary_box(op, a, b):
    """(low, high, status) of an operation on [a, b]."""
    status = WHOLE
    if op == NEG:
        low, high = -b, -a
    elif op == ABS:
        low = 0.0 if a <= 0.0 <= b else min(abs(a), abs(b))
        high = max(abs(a), abs(b))
    elif op == SQUARE:
        low, high = squared(a, b)
        low, high = outward(low, high)
        low = max(low, 0.0)
    elif op == SQRT:
        if b < 0.0:
            return 0.0, 0.0, NOWHERE
        status = WHOLE if a >= 0.0 else PARTIAL
        low, high = outward(np.sqrt(max(a, 0.0)), np.sqrt(b))
        low = max(low, 0.0)
    elif op == SIN:
        low, high = wave(a, b, 0.25 * TURN)
    elif op == COS:
        low, high = wave(a, b, 0.0)
    elif op == EXP:
        low, high = outward(np.exp(a), np.exp(b))
    elif op == LOG:
        if b < 0.0:
            return 0.0, 0.0, NOWHERE
        if a <= 0.0:
            return -np.inf, np.inf, PARTIAL
        low, high = outward(np.log(a), np.log(b))
    elif op == FLOOR:
        low, high = np.floor(a), np.floor(b)
    elif op == COPY:
        low, high = a, b
    else:
        low, high = sign_of(a), sign_of(b)
    return low, high, status


@kernel(f"Tuple((float64, float64, int64))({TAPE}, float64, float64, float64, float64, float64, float64)", _nrt=False)
def box(code, constants, parts, scratch, x0, x1, y0, y1, z0, z1):
    """(low, high, status): f lies in low..high wherever it is defined in the box; ``scratch`` (rows, 8) is overwritten.

    ``status`` says WHOLE (defined all over), PARTIAL (perhaps not) or NOWHERE. Where nothing can be claimed, as for a
    box that is not finite or upside down, the answer is (-inf, inf, PARTIAL).
    """
    last = code.shape[0] - 1
    status = WHOLE
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        found = WHOLE
        if op == CONSTANT:
            low = high = constants[left]
        elif op == X:
            low = x0
            high = x1
        elif op == Y:
            low = y0
            high = y1
        elif op == Z:
            low = z0
            high = z1
        elif op == DENSITY:
            low, high = density_box(parts, left, right, scratch, code[k, 3])
        elif op == SKELETON:
            low, high = skeleton_box(parts, left, right, scratch, code[k, 3])
        elif op <= ATAN2 and op != COPY:
            low, high, found = binary_box(op, scratch[left, 0], scratch[left, 1], scratch[right, 0], scratch[right, 1])
        else:
            low, high, found = unary_box(op, scratch[left, 0], scratch[left, 1])
        if found == NOWHERE:
            return np.inf, -np.inf, NOWHERE
        status = max(status, found)
        if not (low <= high and low > -LARGE and high < LARGE):
            return -np.inf, np.inf, PARTIAL
        scratch[k, 0] = low
        scratch[k, 1] = high
    return low, high, status
