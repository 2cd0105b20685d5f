# mypy: ignore-errors
"""The force of moving air."""

import math

from sceneql.compiled.chance_kernels import noise_in_time
from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import TERM

VELOCITY_AT, COUNT, WORK_AT, INVERSE_AT, LINEAR_AT, QUADRATIC_AT, AIR_AT, GUSTS_AT, PERIOD_AT, SEED = range(10)


@inlined
def air(t, floats, ints):
    """The velocity of the air at a time, gusts included."""
    ux, uy, uz = floats[ints[AIR_AT]], floats[ints[AIR_AT] + 1], floats[ints[AIR_AT] + 2]
    strength = floats[ints[GUSTS_AT]] * math.sqrt(ux * ux + uy * uy + uz * uz)
    if strength > 0.0:
        s = t / floats[ints[PERIOD_AT]]
        ux += strength * noise_in_time(s, 0, ints[SEED])
        uy += strength * noise_in_time(s, 1, ints[SEED])
        uz += strength * noise_in_time(s, 2, ints[SEED])
    return ux, uy, uz


@kernel(TERM, inner=True)
def wind(t, y, rate, floats, ints):
    """Adds -(a + b |w|) w, w = v - u, and takes its power from the work."""
    velocity_at, count, work_at, inverse_at = ints[VELOCITY_AT], ints[COUNT], ints[WORK_AT], ints[INVERSE_AT]
    linear, quadratic = floats[ints[LINEAR_AT]], floats[ints[QUADRATIC_AT]]
    ux, uy, uz = air(t, floats, ints)
    power = 0.0
    for k in range(count):
        if floats[inverse_at + k] == 0.0:
            continue
        at = velocity_at + 3 * k
        vx, vy, vz = y[at], y[at + 1], y[at + 2]
        wx, wy, wz = vx - ux, vy - uy, vz - uz
        c = linear + quadratic * math.sqrt(wx * wx + wy * wy + wz * wz)
        rate[at] -= c * wx
        rate[at + 1] -= c * wy
        rate[at + 2] -= c * wz
        power += c * (wx * vx + wy * vy + wz * vz)
    rate[work_at] += power
