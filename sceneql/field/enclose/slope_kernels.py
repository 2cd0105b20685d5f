# mypy: ignore-errors
"""Bounds of a tape's derivatives over a box: forward differentiation with intervals, after ``interval_kernels.box``.

They bound the generalized gradient (Clarke 1975) where branches of min, max and abs meet, so they are Lipschitz bounds
of f.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.interval_kernels import TINY, TURN, box, hull4, outward, over_cut, unary_box, wave
from sceneql.field.skeleton.density_kernels import offset
from sceneql.field.skeleton.skeleton_bounds_kernels import box_of, skeleton_steepness
from sceneql.field.tape import tape_ops as ops

BLUR = 5.0e-16
"""Rounding of a point on a ray, relative to the magnitudes added."""


@inlined
def times(a, b, c, d):
    """[a, b] [c, d], where zero times anything is zero."""
    if (a == 0.0 and b == 0.0) or (c == 0.0 and d == 0.0):
        return 0.0, 0.0
    return hull4(a * c, a * d, b * c, b * d)


@inlined
def divided(a, b, c, d):
    """[a, b] / [c, d]; all numbers if the divisor may be zero."""
    if c <= 0.0 <= d:
        return -np.inf, np.inf
    return hull4(a / c, a / d, b / c, b / d)


@inlined
def branches(op, a, b, c, d):
    """(derivative by the first argument, by the second) of min or max, as bounds; both 0..1 if neither branch wins."""
    first = (b < c) if op == ops.MIN else (a > d)
    second = (d < a) if op == ops.MIN else (c > b)
    if first:
        return 1.0, 1.0, 0.0, 0.0
    if second:
        return 0.0, 0.0, 1.0, 1.0
    return 0.0, 1.0, 0.0, 1.0


@inlined
def pair_slopes(op, low, high, a, b, c, d):
    """Bounds of the derivatives of an operation on [a, b] and [c, d] with value in [low, high]."""
    if op == ops.ADD:
        return 1.0, 1.0, 1.0, 1.0
    if op == ops.SUB:
        return 1.0, 1.0, -1.0, -1.0
    if op == ops.MUL:
        return c, d, a, b
    if op == ops.DIV:
        p, q = divided(1.0, 1.0, c, d)
        r, s = divided(-high, -low, c, d)
        return p, q, r, s
    if op == ops.MIN or op == ops.MAX:
        return branches(op, a, b, c, d)
    if op == ops.ATAN2:
        p, q, _ = unary_box(ops.SQUARE, a, b)
        r, s, _ = unary_box(ops.SQUARE, c, d)
        p, q = outward(p + r, q + s)
        r, s = divided(c, d, p, q)
        p, q = divided(-b, -a, p, q)
        return r, s, p, q
    if not a > 0.0:
        return -np.inf, np.inf, -np.inf, np.inf
    p, q = divided(low, high, a, b)
    p, q = times(c, d, p, q)
    r, s, _ = unary_box(ops.LOG, a, b)
    r, s = times(low, high, r, s)
    return p, q, r, s


@inlined
def single_slopes(op, low, high, a, b):
    """Bounds of the derivative of an operation on [a, b] with value in [low, high]; infinite where undefined."""
    if op == ops.COPY:
        return 1.0, 1.0
    if op == ops.NEG:
        return -1.0, -1.0
    if op == ops.ABS:
        return -1.0 if a <= 0.0 else 1.0, 1.0 if b >= 0.0 else -1.0
    if op == ops.SQUARE:
        return 2.0 * a, 2.0 * b
    if op == ops.SQRT:
        return divided(0.5, 0.5, low, high)
    if op == ops.SIN:
        return wave(a, b, 0.0)
    if op == ops.COS:
        p, q = wave(a, b, 0.25 * TURN)
        return -q, -p
    if op == ops.EXP:
        return low, high
    if op == ops.LOG:
        return divided(1.0, 1.0, a, b)
    if (op == ops.FLOOR or op == ops.SIGN) and low == high:
        return 0.0, 0.0
    return -np.inf, np.inf


@inlined
def chained(gx, ex, gy, ey, gz, ez, scratch, k, p, columns):
    """Chain rule: bounds of a gradient in the point, times the slopes of its rows p..p+2, into row k of scratch."""
    gx, ex = outward(gx, ex)
    gy, ey = outward(gy, ey)
    gz, ez = outward(gz, ez)
    for column in range(2, columns, 2):
        p0, p1 = times(gx, ex, scratch[p, column], scratch[p, column + 1])
        low, high = times(gy, ey, scratch[p + 1, column], scratch[p + 1, column + 1])
        p0 += low
        p1 += high
        low, high = times(gz, ez, scratch[p + 2, column], scratch[p + 2, column + 1])
        scratch[k, column], scratch[k, column + 1] = outward(p0 + low, p1 + high)


@inlined
def density_slopes(parts, start, stop, scratch, k, p, columns):
    """Bounds of the gradient of a density field times the slopes of its point's rows p..p+2, into row k of scratch."""
    x, y, z, hx, hy, hz = box_of(scratch, p)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz) * (1.0 + 1.0e-12) + 1.0e-14 * (abs(x) + abs(y) + abs(z))
    gx = gy = gz = ex = ey = ez = 0.0
    for i in range(start, stop):
        wx, wy, wz = offset(parts, i, x, y, z)
        radius = parts[i, 6]
        distance = np.sqrt(wx * wx + wy * wy + wz * wz)
        near = max(distance - diagonal, 0.0)
        if near >= radius * (1.0 + 1.0e-12):
            continue
        # The vector from the nearest point of a convex set is 1-Lipschitz in the point.
        most = 1.0 - near * near / (radius * radius)
        far = distance + diagonal
        least = max(1.0 - far * far / (radius * radius), 0.0)
        factor = -6.0 * parts[i, 7] / (radius * radius) * (1.0 + 1.0e-12)
        p0, p1 = times(least * least * (1.0 - 1.0e-12), most * most * (1.0 + 1.0e-12), factor, factor)
        low, high = times(p0, p1, wx - diagonal, wx + diagonal)
        gx += low
        ex += high
        low, high = times(p0, p1, wy - diagonal, wy + diagonal)
        gy += low
        ey += high
        low, high = times(p0, p1, wz - diagonal, wz + diagonal)
        gz += low
        ez += high
    chained(gx, ex, gy, ey, gz, ez, scratch, k, p, columns)


@inlined
def differentiate(code, parts, scratch, columns, dx, dy, dz):
    """Bounds of the derivatives of all rows into columns 2..columns of scratch; returns whether they are finite.

    With 8 columns along x, y and z; with 4 along (dx, dy, dz).
    """
    for k in range(code.shape[0]):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        if op == ops.DENSITY:
            density_slopes(parts, left, right, scratch, k, code[k, 3], columns)
            continue
        if op == ops.SKELETON:
            gx, ex, gy, ey, gz, ez = skeleton_steepness(parts, left, right, scratch, code[k, 3])
            chained(gx, ex, gy, ey, gz, ez, scratch, k, code[k, 3], columns)
            continue
        if op == ops.CONSTANT or (op >= ops.X and op <= ops.Z):
            along = 0.0 if op == ops.CONSTANT else (dx if op == ops.X else (dy if op == ops.Y else dz))
            for column in range(2, columns, 2):
                own = (1.0 if 2 * (op - ops.X) + 2 == column else 0.0) if columns > 4 else along
                scratch[k, column] = own
                scratch[k, column + 1] = own
            continue
        low = scratch[k, 0]
        high = scratch[k, 1]
        if op == ops.ATAN2 and scratch[right, 0] <= 0.0 and scratch[left, 0] <= 0.0 <= scratch[left, 1]:
            if not over_cut(code, scratch, k):
                return False  # it jumps there
        r = s = 0.0
        if op <= ops.ATAN2 and op != ops.COPY:
            p, q, r, s = pair_slopes(
                op, low, high, scratch[left, 0], scratch[left, 1], scratch[right, 0], scratch[right, 1]
            )
        else:
            p, q = single_slopes(op, low, high, scratch[left, 0], scratch[left, 1])
        for column in range(2, columns, 2):
            a, b = times(p, q, scratch[left, column], scratch[left, column + 1])
            if op <= ops.ATAN2 and op != ops.COPY:
                c, d = times(r, s, scratch[right, column], scratch[right, column + 1])
                if op == ops.MIN or op == ops.MAX:
                    if p != q:  # a mean of both
                        a = min(scratch[left, column], scratch[right, column])
                        b = max(scratch[left, column + 1], scratch[right, column + 1])
                        c = d = 0.0
                a, b = outward(a + c, b + d)
            if not (a > -1.0e300 and b < 1.0e300):
                return False
            scratch[k, column] = a
            scratch[k, column + 1] = b
    return True


@lean(
    f"Tuple((float64, float64, float64, float64, int64))({ops.TAPE}, float64, float64, float64, float64, float64,"
    " float64, float64, float64, float64)"
)
def on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, sign):
    """(low, high, least, most, status) on the piece o + t d, t in [t0, t1], of a ray: g = sign f lies in low..high
    wherever it is defined there, and with ``status`` WHOLE dg/dt in least..most, else these are infinite.
    """
    far = max(abs(t0), abs(t1))
    x = BLUR * (abs(ox) + far * abs(dx)) + TINY
    y = BLUR * (abs(oy) + far * abs(dy)) + TINY
    z = BLUR * (abs(oz) + far * abs(dz)) + TINY
    low, high, status = box(
        code,
        constants,
        parts,
        scratch,
        ox + min(t0 * dx, t1 * dx) - x,
        ox + max(t0 * dx, t1 * dx) + x,
        oy + min(t0 * dy, t1 * dy) - y,
        oy + max(t0 * dy, t1 * dy) + y,
        oz + min(t0 * dz, t1 * dz) - z,
        oz + max(t0 * dz, t1 * dz) + z,
    )
    least = -np.inf
    most = np.inf
    if status == ops.WHOLE and differentiate(code, parts, scratch, 4, dx, dy, dz):
        least = scratch[code.shape[0] - 1, 2]
        most = scratch[code.shape[0] - 1, 3]
    if sign < 0.0:
        return -high, -low, -most, -least, status
    return low, high, least, most, status
