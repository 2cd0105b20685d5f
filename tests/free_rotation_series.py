"""The rotation of a rigid body without torque by power series in balls of 45 digits: independent of elliptic functions.

Euler's equations and the quaternion's, with the angular momentum in the body's axes (FLINT's arb for numbers).
"""

from flint import arb, ctx

BITS = 160
ORDER = 36
SMALLEST = 1e-40
"""Of a series' last term beside its first, which sets the length of a step."""


def times(p, q):
    """The product of two quaternions (w, x, y, z)."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


def _at(a, b):
    """The next coefficient of a product of two series."""
    return sum((x * y for x, y in zip(a, reversed(b), strict=True)), arb(0))


def _step(q, m, inverse, left):
    """(q, m, time left) after one step of at most ``left``."""
    q, m = [[x] for x in q], [[x] for x in m]
    w = [[k * x[0]] for k, x in zip(inverse, m, strict=True)]
    for n in range(1, ORDER + 1):
        moved = [
            (_at(m[1], m[2]) * (inverse[2] - inverse[1])) / n,
            (_at(m[2], m[0]) * (inverse[0] - inverse[2])) / n,
            (_at(m[0], m[1]) * (inverse[1] - inverse[0])) / n,
        ]
        turned = [
            -(_at(q[1], w[0]) + _at(q[2], w[1]) + _at(q[3], w[2])) / (2 * n),
            (_at(q[0], w[0]) + _at(q[2], w[2]) - _at(q[3], w[1])) / (2 * n),
            (_at(q[0], w[1]) - _at(q[1], w[2]) + _at(q[3], w[0])) / (2 * n),
            (_at(q[0], w[2]) + _at(q[1], w[1]) - _at(q[2], w[0])) / (2 * n),
        ]
        for series, x in zip([*q, *m], [*turned, *moved], strict=True):
            series.append(x.mid())
        for series, k, x in zip(w, inverse, moved, strict=True):
            series.append((k * x).mid())
    size = sum(float(x[0]) ** 2 for x in m) ** 0.5
    last = max([abs(float(x[k])) ** (1 / k) for x in q for k in (ORDER - 1, ORDER)])
    last = max([last] + [abs(float(x[k]) / size) ** (1 / k) for x in m for k in (ORDER - 1, ORDER)])
    span = abs(left) if last == 0 else min(abs(left), arb(SMALLEST ** (1 / ORDER) / last))
    span = span if left > 0 else -span

    def value(series):
        total = series[-1]
        for x in reversed(series[:-1]):
            total = (total * span + x).mid()
        return total

    return [value(x) for x in q], [value(x) for x in m], left - span


def rotated(q, momentum, moments, h):
    """The quaternion after h seconds, as floats: of ``q`` scaled to length 1."""
    before, ctx.prec = ctx.prec, BITS
    try:
        q = [arb(float(x)) for x in q]
        size = sum((x * x for x in q), arb(0)).sqrt()
        q = [(x / size).mid() for x in q]
        back = (q[0], -q[1], -q[2], -q[3])
        m = times(times(back, (arb(0), *(arb(float(x)) for x in momentum))), q)[1:]
        inverse = [1 / arb(float(x)) for x in moments]
        left = arb(float(h))
        while left != 0:
            q, m, left = _step(q, [x.mid() for x in m], inverse, left)
            left = left.mid()
        return [float(x) for x in q]
    finally:
        ctx.prec = before
