# mypy: ignore-errors
"""The force of drag."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

VELOCITY_AT, COUNT, WORK_AT, INVERSE_AT, LINEAR_AT, QUADRATIC_AT = range(6)


@kernel(TERM, inner=True)
def drag(t, y, rate, floats, ints):
    """Adds -(a + b |v|) v, and its power to the work."""
    velocity_at, count, work_at, inverse_at = ints[VELOCITY_AT], ints[COUNT], ints[WORK_AT], ints[INVERSE_AT]
    linear, quadratic = floats[ints[LINEAR_AT]], floats[ints[QUADRATIC_AT]]
    power = 0.0
    for k in range(count):
        if floats[inverse_at + k] == 0.0:
            continue
        at = velocity_at + 3 * k
        vx, vy, vz = y[at], y[at + 1], y[at + 2]
        square = vx * vx + vy * vy + vz * vz
        c = linear + quadratic * math.sqrt(square)
        rate[at] -= c * vx
        rate[at + 1] -= c * vy
        rate[at + 2] -= c * vz
        power += c * square
    rate[work_at] += power
