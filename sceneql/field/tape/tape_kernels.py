# mypy: ignore-errors
"""Point values of a tape. A NaN anywhere makes the value NaN, so that undefined places are outside."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.enclose.sine_kernels import sine_cosine
from sceneql.field.skeleton.density_kernels import density_value
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.order_kernels import larger, sign_of, smaller

OF_PARTS = types.float64(types.float64[:, ::1], types.int64, types.int64, types.float64, types.float64, types.float64)
skeleton_value = lazy("sceneql.field.skeleton.skeleton_point_kernels:value", OF_PARTS)


@kernel(f"float64({ops.TAPE}, float64, float64, float64)", _nrt=False)
def value(code, constants, parts, scratch, x, y, z):
    """f at a point [m]; ``scratch`` (rows, 8) is overwritten."""
    last = code.shape[0] - 1
    for k in range(last + 1):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        a = scratch[left, 0]
        b = scratch[right, 0]
        if op == ops.CONSTANT:
            v = constants[left]
        elif op == ops.X:
            v = x
        elif op == ops.Y:
            v = y
        elif op == ops.Z:
            v = z
        elif op == ops.COPY:
            v = a
        elif op == ops.ADD:
            v = a + b
        elif op == ops.SUB:
            v = a - b
        elif op == ops.MUL:
            v = a * b
        elif op == ops.DIV:
            v = a / b
        elif op == ops.MIN:
            v = smaller(a, b)
        elif op == ops.MAX:
            v = larger(a, b)
        elif op == ops.NEG:
            v = -a
        elif op == ops.ABS:
            v = abs(a)
        elif op == ops.SQUARE:
            v = a * a
        elif op == ops.SQRT:
            v = np.sqrt(a)
        elif op == ops.SIN or op == ops.COS:
            twin = code[k, 3]
            if twin == 0:
                twin = k
                scratch[k, 4], scratch[k, 5] = sine_cosine(a)
            v = scratch[twin, 4] if op == ops.SIN else scratch[twin, 5]
        elif op == ops.DENSITY:
            p = code[k, 3]
            v = density_value(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
        elif op == ops.SKELETON:
            p = code[k, 3]
            v = skeleton_value(parts, left, right, scratch[p, 0], scratch[p + 1, 0], scratch[p + 2, 0])
        elif op == ops.EXP:
            v = np.exp(a)
        elif op == ops.LOG:
            v = np.log(a)
        elif op == ops.POW:
            v = a**b if a == a and b == b else np.nan  # IEEE has NaN^0 = 1 = 1^NaN
        elif op == ops.ATAN2:
            v = np.arctan2(a, b)
        elif op == ops.FLOOR:
            v = np.floor(a)
        elif op == ops.SIGN:
            v = sign_of(a)
        else:
            v = np.nan
        scratch[k, 0] = v
    return scratch[last, 0]


@kernel(f"void({ops.TAPE}, float64[:, ::1], float64[::1])", _nrt=False)
def values(code, constants, parts, scratch, points, out):
    """f at ``points`` (n, 3) [m] into ``out`` (n,)."""
    for i in range(points.shape[0]):
        out[i] = value(code, constants, parts, scratch, points[i, 0], points[i, 1], points[i, 2])
