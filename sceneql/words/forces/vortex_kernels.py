# mypy: ignore-errors
"""The force of air that rotates about an axis."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, WORK_AT, INVERSE_AT = range(5)
POINT_AT, AXIS_AT, CIRCULATION_AT, UPDRAFT_AT, LINEAR_AT, CORE_AT = range(5, 11)

TAU = 2.0 * math.pi


@kernel(TERM, inner=True)
def vortex(t, y, rate, floats, ints):
    """Adds -c (v - u), and takes its power from the work."""
    position_at, velocity_at, count = ints[POSITION_AT], ints[VELOCITY_AT], ints[COUNT]
    work_at, inverse_at = ints[WORK_AT], ints[INVERSE_AT]
    px, py, pz = floats[ints[POINT_AT]], floats[ints[POINT_AT] + 1], floats[ints[POINT_AT] + 2]
    ax, ay, az = floats[ints[AXIS_AT]], floats[ints[AXIS_AT] + 1], floats[ints[AXIS_AT] + 2]
    length = math.sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax / length, ay / length, az / length
    turning, updraft, c = floats[ints[CIRCULATION_AT]] / TAU, floats[ints[UPDRAFT_AT]], floats[ints[LINEAR_AT]]
    core = floats[ints[CORE_AT]] * floats[ints[CORE_AT]]
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
