# mypy: ignore-errors
"""Values of a tape at many points: operations in the outer loop, points in the inner one, bit for bit as ``value``.

``registers`` (rows, LANES) has a row for each operation; of it and of ``points`` (3, LANES) the first n columns count.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.sine_kernels import wave_lanes
from sceneql.field.skeleton.density_kernels import offset
from sceneql.field.skeleton.skeleton_kernels import skeleton_value
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.order_kernels import larger, sign_of, smaller

LANES = 256
BATCH = "int32[:, ::1], float64[::1], float64[:, ::1], float64[:, ::1]"
"""Types of (code, constants, parts, registers)."""


@inlined
def density_lanes(parts, start, stop, x, y, z, out, n):
    """``density_value`` at n points."""
    for i in range(n):
        out[i] = 0.0
    for part in range(start, stop):
        inverse = parts[part, 6] * parts[part, 6]
        weight = parts[part, 7]
        if parts[part, 0] == parts[part, 3] and parts[part, 1] == parts[part, 4] and parts[part, 2] == parts[part, 5]:
            ax = parts[part, 0]
            ay = parts[part, 1]
            az = parts[part, 2]
            for i in range(n):
                wx = x[i] - ax
                wy = y[i] - ay
                wz = z[i] - az
                u = 1.0 - (wx * wx + wy * wy + wz * wz) / inverse
                u = u if u > 0.0 else 0.0
                out[i] += weight * (u * u * u)
        else:
            for i in range(n):
                wx, wy, wz = offset(parts, part, x[i], y[i], z[i])
                u = 1.0 - (wx * wx + wy * wy + wz * wz) / inverse
                u = u if u > 0.0 else 0.0
                out[i] += weight * (u * u * u)
    for i in range(n):
        s = x[i] + y[i] + z[i]
        out[i] = out[i] if s - s == 0.0 else np.nan


@inlined
def unary_lanes(op, a, out, n):
    """The rarer operations of one argument."""
    if op == ops.ABS:
        for i in range(n):
            out[i] = abs(a[i])
    elif op == ops.SQRT:
        for i in range(n):
            out[i] = np.sqrt(a[i])
    elif op == ops.EXP:
        for i in range(n):
            out[i] = np.exp(a[i])
    elif op == ops.LOG:
        for i in range(n):
            out[i] = np.log(a[i])
    elif op == ops.FLOOR:
        for i in range(n):
            out[i] = np.floor(a[i])
    else:
        for i in range(n):
            out[i] = sign_of(a[i])


@inlined
def binary_lanes(op, a, b, out, n):
    """The rarer operations of two arguments."""
    if op == ops.DIV:
        for i in range(n):
            out[i] = a[i] / b[i]
    elif op == ops.MIN:
        for i in range(n):
            out[i] = smaller(a[i], b[i])
    elif op == ops.MAX:
        for i in range(n):
            out[i] = larger(a[i], b[i])
    elif op == ops.POW:
        for i in range(n):
            out[i] = a[i] ** b[i] if a[i] == a[i] and b[i] == b[i] else np.nan
    else:
        for i in range(n):
            out[i] = np.arctan2(a[i], b[i])


@inlined
def along_z(code, rest):
    """Write into ``rest`` (rows, 4) the tape of the rows that depend on z; all other rows become KEEP."""
    for k in range(code.shape[0]):
        op = code[k, 0]
        for j in range(1, 4):
            rest[k, j] = code[k, j]
        if op == ops.CONSTANT or op == ops.X or op == ops.Y:
            kept = True
        elif op == ops.Z:
            kept = False
        elif op == ops.DENSITY or op == ops.SKELETON:
            p = code[k, 3]
            kept = rest[p, 0] == ops.KEEP and rest[p + 1, 0] == ops.KEEP and rest[p + 2, 0] == ops.KEEP
        else:
            kept = rest[code[k, 1], 0] == ops.KEEP and rest[code[k, 2], 0] == ops.KEEP
        rest[k, 0] = ops.KEEP if kept else op


@lean(f"void({BATCH}, float64[:, ::1], int64)")
def evaluate(code, constants, parts, registers, points, n):
    """f at n points, into the first n columns of the last register."""
    for k in range(code.shape[0]):
        op = code[k, 0]
        if op == ops.KEEP:
            continue
        left = code[k, 1]
        right = code[k, 2]
        out = registers[k]
        if op == ops.CONSTANT:
            number = constants[left]
            for i in range(n):
                out[i] = number
            continue
        if op == ops.X or op == ops.Y or op == ops.Z:
            p = points[op - ops.X]
            for i in range(n):
                out[i] = p[i]
            continue
        if op == ops.DENSITY:
            p = code[k, 3]
            density_lanes(parts, left, right, registers[p], registers[p + 1], registers[p + 2], out, n)
            continue
        if op == ops.SKELETON:
            p = code[k, 3]
            for i in range(n):
                out[i] = skeleton_value(parts, left, right, registers[p, i], registers[p + 1, i], registers[p + 2, i])
            continue
        a = registers[left]
        b = registers[right]
        if op == ops.ADD:
            for i in range(n):
                out[i] = a[i] + b[i]
        elif op == ops.SUB:
            for i in range(n):
                out[i] = a[i] - b[i]
        elif op == ops.MUL:
            for i in range(n):
                out[i] = a[i] * b[i]
        elif op == ops.SQUARE:
            for i in range(n):
                out[i] = a[i] * a[i]
        elif op == ops.NEG:
            for i in range(n):
                out[i] = -a[i]
        elif op == ops.COPY:
            for i in range(n):
                out[i] = a[i]
        elif op == ops.SIN or op == ops.COS:
            wave_lanes(a, out, n, op == ops.COS)
        elif op <= ops.ATAN2:
            binary_lanes(op, a, b, out, n)
        else:
            unary_lanes(op, a, out, n)
