# mypy: ignore-errors
"""The force of air that runs round an axis."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

TAU = 2.0 * math.pi


@kernel(TERM, inner=True)
def vortex(t, y, rate, floats, ints):
    """Adds -c (v - u), and takes its power from the work.

    ints: position_at, velocity_at, count, work_at, inverse_at, point_at, axis_at, circulation_at, updraft_at,
    linear_at, core_at.
    """
    position_at, velocity_at, count, work_at, inverse_at = ints[0], ints[1], ints[2], ints[3], ints[4]
    px, py, pz = floats[ints[5]], floats[ints[5] + 1], floats[ints[5] + 2]
    ax, ay, az = floats[ints[6]], floats[ints[6] + 1], floats[ints[6] + 2]
    length = math.sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax / length, ay / length, az / length
    turning, updraft, c = floats[ints[7]] / TAU, floats[ints[8]], floats[ints[9]]
    core = floats[ints[10]] * floats[ints[10]]
    power = 0.0
    for k in range(count):
        if floats[inverse_at + k] == 0.0:
            continue
        at = position_at + 3 * k
        dx, dy, dz = y[at] - px, y[at + 1] - py, y[at + 2] - pz
        along = dx * ax + dy * ay + dz * az
        dx, dy, dz = dx - along * ax, dy - along * ay, dz - along * az
        square = dx * dx + dy * dy + dz * dz
        swirl = -turning * math.expm1(-square / core) / square if square > 0.0 else turning / core
        up = updraft * math.exp(-square / core)
        at = velocity_at + 3 * k
        vx, vy, vz = y[at], y[at + 1], y[at + 2]
        wx = vx - swirl * (ay * dz - az * dy) - up * ax
        wy = vy - swirl * (az * dx - ax * dz) - up * ay
        wz = vz - swirl * (ax * dy - ay * dx) - up * az
        rate[at] -= c * wx
        rate[at + 1] -= c * wy
        rate[at + 2] -= c * wz
        power += c * (wx * vx + wy * vy + wz * vz)
    rate[work_at] += power
