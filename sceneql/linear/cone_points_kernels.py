# mypy: ignore-errors
"""The interior-point method's algebra at a contact: Nesterov and Todd's scaling of the second-order cone, steps in it.

Source: Nesterov & Todd (1997), Math. Oper. Res. 22, 1-42; formulas as in Vandenberghe (2010), The CVXOPT linear and
quadratic cone program solvers, sections 4.2 and 8.3: W maps x and its inverse maps s to one scaled point.
"""

import math

from sceneql.compiled.kernels import lean_inlined
from sceneql.linear.cone_rows_kernels import (
    AT_DS,
    AT_ETA,
    AT_H,
    AT_LAMBDA,
    AT_Q,
    AT_S,
    AT_W,
    AT_X,
    put,
)


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
