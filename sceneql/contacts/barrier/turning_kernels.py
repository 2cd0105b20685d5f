# mypy: ignore-errors
"""How places of rigid bodies move as their state changes in a line: centers go straight, quaternions turn."""

import math

from sceneql.bodies.rigid.place_kernels import ARM_AT, POSITION_AT, ROTATION_AT
from sceneql.bodies.rigid.rigid_kernels import THREE
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, F, I, N


@lean(THREE(A, A, A, I, N, F))
def swept(y, changed, floats, ints, at, part):
    """Where the place of ints[at:] (system.Place) is after a part of the way from y to ``changed`` [m]."""
    x, q, k = ints[at + POSITION_AT], ints[at + ROTATION_AT], ints[at + ARM_AT]
    a, b = y[q] + part * (changed[q] - y[q]), y[q + 1] + part * (changed[q + 1] - y[q + 1])
    c, d = y[q + 2] + part * (changed[q + 2] - y[q + 2]), y[q + 3] + part * (changed[q + 3] - y[q + 3])
    rx, ry, rz = floats[k], floats[k + 1], floats[k + 2]
    # As rigid_kernels.to_world.
    s = 2.0 / (a * a + b * b + c * c + d * d)
    px, py, pz = c * rz - d * ry, d * rx - b * rz, b * ry - c * rx
    ux, uy, uz = c * pz - d * py, d * px - b * pz, b * py - c * px
    return (
        y[x] + part * (changed[x] - y[x]) + rx + s * (ux + a * px),
        y[x + 1] + part * (changed[x + 1] - y[x + 1]) + ry + s * (uy + a * py),
        y[x + 2] + part * (changed[x + 2] - y[x + 2]) + rz + s * (uz + a * pz),
    )


@lean(F(A, A, A, I, N))
def turned(y, changed, floats, ints, at):
    """The largest speed of the place of ints[at:] by turning, over parts of that way [m].

    The direction of q = a + s (b - a) turns at no more than |a| |b - a| / |q|^2, which is largest where the line is
    nearest to 0; the body turns twice as fast.
    """
    q, k = ints[at + ROTATION_AT], ints[at + ARM_AT]
    aa = along = away = 0.0
    for c in range(q, q + 4):
        d = changed[c] - y[c]
        aa, along, away = aa + y[c] * y[c], along + y[c] * d, away + d * d
    if away == 0.0:
        return 0.0
    part = min(1.0, max(0.0, -along / away))
    nearest = aa + part * (2.0 * along + part * away)
    reach = math.sqrt(floats[k] ** 2 + floats[k + 1] ** 2 + floats[k + 2] ** 2)
    return 2.0 * math.sqrt(aa * away) / nearest * reach if nearest > 0.0 else math.inf
