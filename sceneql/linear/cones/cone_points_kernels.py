# mypy: ignore-errors
"""Contacts one by one: their frames and masses; the interior-point method's algebra, Nesterov and Todd's scaling.

Source: Nesterov & Todd (1997), Math. Oper. Res. 22, 1-42; formulas as in Vandenberghe (2010), The CVXOPT linear and
quadratic cone program solvers, sections 4.2 and 8.3: W maps x and its inverse maps s to one scaled point.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.cones.cone_layout_kernels import (
    AT_ARM_A,
    AT_B,
    AT_DS,
    AT_ETA,
    AT_FRAME,
    AT_FRICTION,
    AT_GIVEN,
    AT_H,
    AT_HEAVY,
    AT_IMPULSE,
    AT_INERTIA,
    AT_INVERSE,
    AT_LAMBDA,
    AT_MASS,
    AT_NORMAL,
    AT_Q,
    AT_S,
    AT_W,
    AT_X,
    BODIES,
    BODIES_AT,
    BODY,
    CONTACT,
    CONTACTS,
    CONTACTS_AT,
    ROWS,
    prepare_rows,
)
from sceneql.linear.cones.cone_rows_kernels import cross, pair_of, put, turned
from sceneql.system.signatures_kernels import A, I, N


@lean_inlined
def tail(floats, at):
    """The length of the last two of three numbers."""
    return math.sqrt(floats[at + 1] * floats[at + 1] + floats[at + 2] * floats[at + 2])


@lean_inlined
def determinant(floats, at):
    """x_0^2 - |x_T|^2 of a point in the cone."""
    length = tail(floats, at)
    return (floats[at] - length) * (floats[at] + length)


@lean_inlined
def inner(floats, at, to):
    """The product of two points."""
    return floats[at] * floats[to] + floats[at + 1] * floats[to + 1] + floats[at + 2] * floats[to + 2]


@lean_inlined
def scaled(floats, c, x, y, z, sign):
    """W (sign 1) or its inverse (-1) times a vector."""
    a, b, d = floats[c + AT_W], sign * floats[c + AT_W + 1], sign * floats[c + AT_W + 2]
    along = b * y + d * z
    by = floats[c + AT_ETA] if sign > 0.0 else 1.0 / floats[c + AT_ETA]
    rest = x + along / (1.0 + a)
    return by * (a * x + along), by * (y + b * rest), by * (z + d * rest)


@lean_inlined
def scale(floats, c):
    """Write W, the scaled point and H = W^-2 for x and s of a contact; False where one is not inside the cone."""
    x, s = c + AT_X, c + AT_S
    p, q = determinant(floats, x), determinant(floats, s)
    if not (p > 0.0 and q > 0.0 and floats[x] > 0.0 and floats[s] > 0.0):
        return False
    p, q = math.sqrt(p), math.sqrt(q)
    half = math.sqrt(0.5 * (1.0 + inner(floats, x, s) / (p * q)))
    a = 0.5 * (floats[s] / q + floats[x] / p) / half
    b = 0.5 * (floats[s + 1] / q - floats[x + 1] / p) / half
    d = 0.5 * (floats[s + 2] / q - floats[x + 2] / p) / half
    put(floats, c + AT_W, math.sqrt(1.0 + b * b + d * d), b, d)
    floats[c + AT_ETA] = math.sqrt(q / p)
    put(floats, c + AT_LAMBDA, *scaled(floats, c, floats[x], floats[x + 1], floats[x + 2], 1.0))
    by, h = p / q, c + AT_H
    put(floats, h, by * (1.0 + 2.0 * (b * b + d * d)), -2.0 * by * a * b, -2.0 * by * a * d)
    put(floats, h + 3, floats[h + 1], by * (1.0 + 2.0 * b * b), 2.0 * by * b * d)
    put(floats, h + 6, floats[h + 2], floats[h + 5], by * (1.0 + 2.0 * d * d))
    return True


@lean_inlined
def reach(floats, at, x, y, z):
    """Largest step along a direction that keeps the point at floats[at:] in the cone."""
    a = x * x - y * y - z * z
    b = floats[at] * x - floats[at + 1] * y - floats[at + 2] * z
    c = determinant(floats, at)
    # Never negative but for rounding, as c > 0.
    below = math.sqrt(max(b * b - a * c, 0.0)) - b
    return c / below if below > 0.0 else math.inf


@lean_inlined
def scaled_step(floats, c):
    """Largest step for x and s of a contact along DX and DS, both scaled: W dx = Q - W^-1 ds."""
    ds = c + AT_DS
    x, y, z = scaled(floats, c, floats[ds], floats[ds + 1], floats[ds + 2], -1.0)
    one = reach(floats, c + AT_LAMBDA, x, y, z)
    q = c + AT_Q
    return min(one, reach(floats, c + AT_LAMBDA, floats[q] - x, floats[q + 1] - y, floats[q + 2] - z))


@lean_inlined
def aim(floats, c, centered):
    """Q of the corrector, from DS and Q of the predictor (Mehrotra 1992): lambda o Q is the whole right hand side."""
    ds, q, point = c + AT_DS, c + AT_Q, c + AT_LAMBDA
    x, y, z = scaled(floats, c, floats[ds], floats[ds + 1], floats[ds + 2], -1.0)
    u, v, w = floats[q] - x, floats[q + 1] - y, floats[q + 2] - z
    p, m, n = floats[point], floats[point + 1], floats[point + 2]
    d = centered - (p * p + m * m + n * n) - (x * u + y * v + z * w)
    e = -2.0 * p * m - (x * v + u * y)
    f = -2.0 * p * n - (x * w + u * z)
    first = (p * d - m * e - n * f) / determinant(floats, point)
    put(floats, q, first, (e - m * first) / p, (f - n * first) / p)


@lean(types.void(A, N))
def invert(floats, at):
    """The inverse of a body's inertia; 0 where it has none."""
    i = at + AT_INERTIA
    scale = max(floats[i], floats[i + 4], floats[i + 8])
    by = 1.0 / scale if scale > 0.0 else 0.0
    a, b, c = floats[i] * by, floats[i + 4] * by, floats[i + 8] * by
    d, e, f = floats[i + 5] * by, floats[i + 2] * by, floats[i + 1] * by
    u, v, w = b * c - d * d, d * e - f * c, f * d - b * e
    whole = a * u + f * v + e * w
    by = by / whole if whole > 0.0 else 0.0
    put(floats, at + AT_INVERSE, u * by, v * by, w * by)
    put(floats, at + AT_INVERSE + 3, v * by, (a * c - e * e) * by, (e * f - a * d) * by)
    put(floats, at + AT_INVERSE + 6, w * by, (e * f - a * d) * by, (a * b - f * f) * by)


@lean_inlined
def lightness(floats, at, arm, x, y, z):
    """Velocity of a body's point along a direction by an impulse of 1 along it."""
    u, v, w = cross(floats[arm], floats[arm + 1], floats[arm + 2], x, y, z)
    p, q, r = turned(floats, at + AT_INVERSE, u, v, w)
    return 1.0 / floats[at + AT_MASS] + u * p + v * q + w * r


@lean(types.void(A, I))
def prepare(floats, ints):
    """Write the frames, the given velocities and guessed impulses in them, the effective masses."""
    for body in range(ints[BODIES]):
        invert(floats, ints[BODIES_AT] + BODY * body)
    for k in range(ints[CONTACTS]):
        c, pair = ints[CONTACTS_AT] + CONTACT * k, pair_of(ints, k)
        nx, ny, nz = floats[c + AT_NORMAL], floats[c + AT_NORMAL + 1], floats[c + AT_NORMAL + 2]
        if abs(nx) <= abs(ny) and abs(nx) <= abs(nz):
            tx, ty, tz = 0.0, nz, -ny
        elif abs(ny) <= abs(nz):
            tx, ty, tz = -nz, 0.0, nx
        else:
            tx, ty, tz = ny, -nx, 0.0
        by = 1.0 / math.sqrt(tx * tx + ty * ty + tz * tz)
        tx, ty, tz = tx * by, ty * by, tz * by
        ox, oy, oz = cross(nx, ny, nz, tx, ty, tz)
        light = 0.0
        for side in range(2):
            if ints[pair + side] >= 0:
                at, arm = ints[BODIES_AT] + BODY * ints[pair + side], c + AT_ARM_A + 3 * side
                light += lightness(floats, at, arm, nx, ny, nz)
                light += lightness(floats, at, arm, tx, ty, tz) + lightness(floats, at, arm, ox, oy, oz)
        floats[c + AT_HEAVY] = 3.0 / light
        friction = floats[c + AT_FRICTION]
        rough = 1.0 if friction > 0.0 else 0.0
        mu = friction if friction > 0.0 else 1.0
        frame = c + AT_FRAME
        put(floats, frame, nx / mu, ny / mu, nz / mu)
        put(floats, frame + 3, rough * tx, rough * ty, rough * tz)
        put(floats, frame + 6, rough * ox, rough * oy, rough * oz)
        for given, to in ((c + AT_GIVEN, c + AT_B), (c + AT_IMPULSE, c + AT_X)):
            put(floats, to, *turned(floats, frame, floats[given], floats[given + 1], floats[given + 2]))
        floats[c + AT_X] *= mu * mu
    if ints[ROWS] > 0:
        prepare_rows(floats, ints)
