# mypy: ignore-errors
"""The force of moving air."""

import math

from sceneql.compiled.chance_kernels import noise_in_time
from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import TERM


@inlined
def air(t, floats, ints):
    """The velocity of the air at a time, gusts and all; ints as for `wind`."""
    ux, uy, uz = floats[ints[6]], floats[ints[6] + 1], floats[ints[6] + 2]
    strength = floats[ints[7]] * math.sqrt(ux * ux + uy * uy + uz * uz)
    if strength > 0.0:
        s = t / floats[ints[8]]
        ux += strength * noise_in_time(s, 0, ints[9])
        uy += strength * noise_in_time(s, 1, ints[9])
        uz += strength * noise_in_time(s, 2, ints[9])
    return ux, uy, uz


@kernel(TERM, inner=True)
def wind(t, y, rate, floats, ints):
    """Adds -(a + b |w|) w, w = v - u, and takes its power from the work.

    ints: velocity_at, count, work_at, inverse_at, linear_at, quadratic_at, air_at, gusts_at, period_at, seed.
    """
    velocity_at, count, work_at, inverse_at = ints[0], ints[1], ints[2], ints[3]
    linear, quadratic = floats[ints[4]], floats[ints[5]]
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
