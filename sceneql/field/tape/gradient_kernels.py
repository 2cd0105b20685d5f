# mypy: ignore-errors
"""Gradients of a tape at points. A NaN anywhere makes the value NaN, so that undefined places are outside."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.skeleton.density_kernels import density_gradient
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.tape_kernels import value

OF_PARTS = types.UniTuple(types.float64, 3)(
    types.float64[:, ::1], types.int64, types.int64, types.float64, types.float64, types.float64
)
skeleton_gradient = lazy("sceneql.field.skeleton.skeleton_point_kernels:gradient", OF_PARTS)


@inlined
def slopes(op, v, a, b):
    """Partial derivatives of v = op(a, b) with respect to a and b; at a kink a one-sided derivative, or 0."""
    if op == ops.ADD:
        return 1.0, 1.0
    if op == ops.SUB:
        return 1.0, -1.0
    if op == ops.MUL:
        return b, a
    if op == ops.DIV:
        return 1.0 / b, -v / b
    if op == ops.MIN:
        return (1.0, 0.0) if a < b else (0.0, 1.0)
    if op == ops.MAX:
        return (1.0, 0.0) if a > b else (0.0, 1.0)
    if op == ops.COPY:
        return 1.0, 0.0
    if op == ops.NEG:
        return -1.0, 0.0
    if op == ops.ABS:
        return (-1.0 if a < 0.0 else 1.0), 0.0
    if op == ops.SQUARE:
        return 2.0 * a, 0.0
    if op == ops.SQRT:
        return (0.5 / v if v > 0.0 else 0.0), 0.0
    if op == ops.EXP:
        return v, 0.0
    if op == ops.LOG:
        return 1.0 / a, 0.0
    if op == ops.POW:
        if a == 0.0:
            return (1.0 if b == 1.0 else 0.0), 0.0
        return b * a ** (b - 1.0), (v * np.log(a) if a > 0.0 else 0.0)
    if op == ops.ATAN2:
        r2 = a * a + b * b
        return (b / r2, -a / r2) if r2 > 0.0 else (0.0, 0.0)
    return 0.0, 0.0


@kernel(f"UniTuple(float64, 4)({ops.TAPE}, float64, float64, float64)", _nrt=False)
def gradient(code, constants, parts, scratch, x, y, z):
    """f and its three derivatives at a point, by forward differentiation; ``scratch`` (rows, 8) is overwritten."""
    value(code, constants, parts, scratch, x, y, z)
    last = code.shape[0] - 1
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        gx = gy = gz = 0.0
        if op == ops.X:
            gx = 1.0
        elif op == ops.Y:
            gy = 1.0
        elif op == ops.Z:
            gz = 1.0
        elif op == ops.DENSITY or op == ops.SKELETON:
            p = code[k, 3]
            if op == ops.DENSITY:
                u, v, w = density_gradient(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
            else:
                u, v, w = skeleton_gradient(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
            gx = u * scratch[p, 1] + v * scratch[p + 1, 1] + w * scratch[p + 2, 1]
            gy = u * scratch[p, 2] + v * scratch[p + 1, 2] + w * scratch[p + 2, 2]
            gz = u * scratch[p, 3] + v * scratch[p + 1, 3] + w * scratch[p + 2, 3]
        elif op != ops.CONSTANT:
            if op == ops.SIN or op == ops.COS:
                twin = code[k, 3] if code[k, 3] else k
                u = scratch[twin, 5] if op == ops.SIN else -scratch[twin, 4]
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
