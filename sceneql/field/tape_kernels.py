# mypy: ignore-errors
"""Point values and gradients of a tape. A NaN anywhere makes the value NaN, so that undefined places are outside."""

import numpy as np

from sceneql.field.density_kernels import density_gradient, density_value
from sceneql.field.order_kernels import larger, sign_of, smaller
from sceneql.field.sine_kernels import sine_cosine
from sceneql.field.skeleton_kernels import skeleton_gradient, skeleton_value
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
    POW,
    SIGN,
    SIN,
    SKELETON,
    SQRT,
    SQUARE,
    SUB,
    TAPE,
    X,
    Y,
    Z,
)
from sceneql.kernels import inlined, kernel


@kernel(f"float64({TAPE}, float64, float64, float64)", _nrt=False)
def value(code, constants, parts, scratch, x, y, z):
    """f at a point [m]; ``scratch`` (rows, 8) is overwritten."""
    last = code.shape[0] - 1
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        a = scratch[left, 0]
        b = scratch[right, 0]
        if op == CONSTANT:
            v = constants[left]
        elif op == X:
            v = x
        elif op == Y:
            v = y
        elif op == Z:
            v = z
        elif op == COPY:
            v = a
        elif op == ADD:
            v = a + b
        elif op == SUB:
            v = a - b
        elif op == MUL:
            v = a * b
        elif op == DIV:
            v = a / b
        elif op == MIN:
            v = smaller(a, b)
        elif op == MAX:
            v = larger(a, b)
        elif op == NEG:
            v = -a
        elif op == ABS:
            v = abs(a)
        elif op == SQUARE:
            v = a * a
        elif op == SQRT:
            v = np.sqrt(a)
        elif op == SIN or op == COS:
            twin = code[k, 3]
            if twin == 0:
                twin = k
                scratch[k, 4], scratch[k, 5] = sine_cosine(a)
            v = scratch[twin, 4] if op == SIN else scratch[twin, 5]
        elif op == DENSITY:
            p = code[k, 3]
            v = density_value(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
        elif op == SKELETON:
            p = code[k, 3]
            v = skeleton_value(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
        elif op == EXP:
            v = np.exp(a)
        elif op == LOG:
            v = np.log(a)
        elif op == POW:
            v = a**b if a == a and b == b else np.nan  # IEEE has NaN^0 = 1 = 1^NaN
        elif op == ATAN2:
            v = np.arctan2(a, b)
        elif op == FLOOR:
            v = np.floor(a)
        elif op == SIGN:
            v = sign_of(a)
        else:
            v = np.nan
        scratch[k, 0] = v
    return scratch[last, 0]


@kernel(f"void({TAPE}, float64[:, ::1], float64[::1])", _nrt=False)
def values(code, constants, parts, scratch, points, out):
    """f at ``points`` (n, 3) [m] into ``out`` (n,)."""
    for i in range(points.shape[0]):
        out[i] = value(code, constants, parts, scratch, points[i, 0], points[i, 1], points[i, 2])


@inlined
def slopes(op, v, a, b):
    """Derivatives of v = op(a, b) with respect to a and b; at a kink those of one side, or 0."""
    if op == ADD:
        return 1.0, 1.0
    if op == SUB:
        return 1.0, -1.0
    if op == MUL:
        return b, a
    if op == DIV:
        return 1.0 / b, -v / b
    if op == MIN:
        return (1.0, 0.0) if a < b else (0.0, 1.0)
    if op == MAX:
        return (1.0, 0.0) if a > b else (0.0, 1.0)
    if op == COPY:
        return 1.0, 0.0
    if op == NEG:
        return -1.0, 0.0
    if op == ABS:
        return (-1.0 if a < 0.0 else 1.0), 0.0
    if op == SQUARE:
        return 2.0 * a, 0.0
    if op == SQRT:
        return (0.5 / v if v > 0.0 else 0.0), 0.0
    if op == EXP:
        return v, 0.0
    if op == LOG:
        return 1.0 / a, 0.0
    if op == POW:
        if a == 0.0:
            return (1.0 if b == 1.0 else 0.0), 0.0
        return b * a ** (b - 1.0), (v * np.log(a) if a > 0.0 else 0.0)
    if op == ATAN2:
        r2 = a * a + b * b
        return (b / r2, -a / r2) if r2 > 0.0 else (0.0, 0.0)
    return 0.0, 0.0


@kernel(f"UniTuple(float64, 4)({TAPE}, float64, float64, float64)", _nrt=False)
def gradient(code, constants, parts, scratch, x, y, z):
    """f and its three derivatives at a point, by forward differentiation; ``scratch`` (rows, 8) is overwritten."""
    value(code, constants, parts, scratch, x, y, z)
    last = code.shape[0] - 1
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        gx = gy = gz = 0.0
        if op == X:
            gx = 1.0
        elif op == Y:
            gy = 1.0
        elif op == Z:
            gz = 1.0
        elif op == DENSITY or op == SKELETON:
            p = code[k, 3]
            if op == DENSITY:
                u, v, w = density_gradient(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
            else:
                u, v, w = skeleton_gradient(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
            gx = u * scratch[p, 1] + v * scratch[p + 1, 1] + w * scratch[p + 2, 1]
            gy = u * scratch[p, 2] + v * scratch[p + 1, 2] + w * scratch[p + 2, 2]
            gz = u * scratch[p, 3] + v * scratch[p + 1, 3] + w * scratch[p + 2, 3]
        elif op != CONSTANT:
            if op == SIN or op == COS:
                twin = code[k, 3] if code[k, 3] else k
                u = scratch[twin, 5] if op == SIN else -scratch[twin, 4]
                v = 0.0
            else:
                u, v = slopes(op, scratch[k, 0], scratch[left, 0], scratch[right, 0])
            # A zero slope is skipped: zero times an infinite slope of the branch not taken would be NaN.
            if u != 0.0:
                gx = u * scratch[left, 1]
                gy = u * scratch[left, 2]
                gz = u * scratch[left, 3]
            if v != 0.0:
                gx += v * scratch[right, 1]
                gy += v * scratch[right, 2]
                gz += v * scratch[right, 3]
        scratch[k, 1] = gx
        scratch[k, 2] = gy
        scratch[k, 3] = gz
    return scratch[last, 0], scratch[last, 1], scratch[last, 2], scratch[last, 3]
