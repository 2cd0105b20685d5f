# mypy: ignore-errors
"""The force of a spring that leads to a point of a rigid body."""

import math

from sceneql.bodies.rigid.place_kernels import PLACE, POSITION_AT, WORK_AT, push, velocity, where
from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

STIFFNESS_AT, DAMPING_AT, REST_AT, SPEEDS_AT = range(2 * PLACE, 2 * PLACE + 4)
"""Behind the two places, of which one that is no mass begins with -1 and the offset of where it is. From SPEEDS_AT on,
for each end, the offset of such a place's velocity in the floats, or -1."""


@kernel(TERM, inner=True)
def spring(t, y, rate, floats, ints):
    """Adds the force on both ends, and to the work the damping's power (half for each) and that of a prescribed end."""
    ax, ay, az = where(y, floats, ints, 0)
    bx, by, bz = where(y, floats, ints, PLACE)
    dx, dy, dz = bx - ax, by - ay, bz - az
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return
    dx, dy, dz = dx / length, dy / length, dz / length
    leading = following = 0.0
    for end in range(2):
        own = PLACE * end
        if ints[own + POSITION_AT] >= 0:
            vx, vy, vz = velocity(y, floats, ints, own)
        else:
            u = ints[SPEEDS_AT + end]
            vx, vy, vz = floats[u], floats[u + 1], floats[u + 2]
        if end == 0:
            leading = dx * vx + dy * vy + dz * vz
        else:
            following = dx * vx + dy * vy + dz * vz
    opening = following - leading
    damping = floats[ints[DAMPING_AT]]
    pull = floats[ints[STIFFNESS_AT]] * (length - floats[ints[REST_AT]]) + damping * opening
    lost = damping * opening * opening
    a, b = ints[POSITION_AT] >= 0, ints[PLACE + POSITION_AT] >= 0
    if a:
        push(y, rate, floats, ints, 0, pull * dx, pull * dy, pull * dz)
        rate[ints[WORK_AT]] += 0.5 * lost if b else lost - pull * following
    if b:
        push(y, rate, floats, ints, PLACE, -pull * dx, -pull * dy, -pull * dz)
        rate[ints[PLACE + WORK_AT]] += 0.5 * lost if a else lost + pull * leading
