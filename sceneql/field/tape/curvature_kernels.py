# mypy: ignore-errors
"""Bounds of a tape's second derivatives along the axes in a box."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.interval_kernels import outward, squared
from sceneql.field.enclose.slope_kernels import branches, divided, single_slopes, times
from sceneql.field.skeleton.density_curvature_kernels import density_curvature
from sceneql.field.tape import tape_ops as ops


@inlined
def single_curvature(op, low, high, a, b):
    """Bounds of the second derivative of an operation on [a, b] with value in [low, high]; infinite where undefined."""
    if op == ops.SQUARE:
        return 2.0, 2.0
    if op == ops.SQRT:
        p, q = divided(-0.25, -0.25, low, high)
        p, q = divided(p, q, low, high)
        return divided(p, q, low, high)
    if op == ops.SIN or op == ops.COS:
        return -high, -low
    if op == ops.EXP:
        return low, high
    if op == ops.LOG:
        p, q = divided(-1.0, -1.0, a, b)
        return divided(p, q, a, b)
    if op == ops.ABS and a <= 0.0 <= b:
        return -np.inf, np.inf
    return 0.0, 0.0


@inlined
def of_power(low, high, a, b, n):
    """Bounds of the first and of the second derivative of u^n in [low, high], for u in [a, b] above 0."""
    p, q = divided(low, high, a, b)
    r, s = divided(p, q, a, b)
    p, q = times(p, q, n, n)
    r, s = times(r, s, n * (n - 1.0), n * (n - 1.0))
    return p, q, r, s


@lean("boolean(int32[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def curvature(code, parts, scratch, second):
    """Bounds of the second derivatives along x, y and z of all rows into ``second`` (rows, 6); whether all are known.

    For the box for which ``box`` left WHOLE, and ``steepness`` finite bounds, in scratch. Unknown are those of
    skeletons and angles, and where branches of min, max and abs meet.
    """
    for k in range(code.shape[0]):
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        if op == ops.SKELETON or op == ops.ATAN2:
            return False
        if op == ops.DENSITY:
            if not density_curvature(parts, left, right, scratch, second, k, code[k, 3]):
                return False
            continue
        if op <= ops.Z:
            for column in range(6):
                second[k, column] = 0.0
            continue
        low, high, a, b = scratch[k, 0], scratch[k, 1], scratch[left, 0], scratch[left, 1]
        pair = op <= ops.ATAN2 and op != ops.COPY
        c, d = (scratch[right, 0], scratch[right, 1]) if pair else (0.0, 0.0)
        p = q = r = s = 0.0
        if op == ops.MIN or op == ops.MAX:
            p, q, r, s = branches(op, a, b, c, d)
            if p != q:
                return False
        elif op == ops.POW:
            if not (a > 0.0 and c == d):
                return False
            p, q, r, s = of_power(low, high, a, b, c)
        elif not pair:
            p, q = single_slopes(op, low, high, a, b)
            r, s = single_curvature(op, low, high, a, b)
        for axis in range(3):
            at, to = 2 * axis, 2 * axis + 1
            ua, ub = second[left, at], second[left, to]
            fa, fb = scratch[left, at + 2], scratch[left, to + 2]
            if op == ops.MIN or op == ops.MAX:
                kept = left if p == 1.0 else right
                low, high = second[kept, at], second[kept, to]
            elif op == ops.ADD:
                low, high = outward(ua + second[right, at], ub + second[right, to])
            elif op == ops.SUB:
                low, high = outward(ua - second[right, to], ub - second[right, at])
            elif op == ops.MUL:
                e, f = times(ua, ub, c, d)
                g, h = times(fa, fb, scratch[right, at + 2], scratch[right, to + 2])
                v, w = times(a, b, second[right, at], second[right, to])
                low, high = outward(e + 2.0 * g + v, f + 2.0 * h + w)
            elif op == ops.DIV:  # from u = (u / v) v, differentiated twice
                g, h = times(scratch[k, at + 2], scratch[k, to + 2], scratch[right, at + 2], scratch[right, to + 2])
                v, w = times(scratch[k, 0], scratch[k, 1], second[right, at], second[right, to])
                e, f = outward(ua - 2.0 * h - w, ub - 2.0 * g - v)
                low, high = divided(e, f, c, d)
            else:
                e, f = times(p, q, ua, ub)
                g, h = squared(fa, fb)
                g, h = outward(g, h)
                g, h = times(r, s, g, h)
                low, high = outward(e + g, f + h)
            if not (low > -1.0e300 and high < 1.0e300):
                return False
            second[k, at] = low
            second[k, to] = high
    return True


@inlined
def bulge(second, last):
    """(most that f lies below, most that it lies above) what is linear along each axis between the corners of a cube
    of side 1, by the bounds that ``curvature`` left: an eighth of the second derivative along each axis.
    """
    below = above = 0.0
    for axis in range(3):
        below += max(second[last, 2 * axis + 1], 0.0)
        above += max(-second[last, 2 * axis], 0.0)
    return 0.125 * below, 0.125 * above
