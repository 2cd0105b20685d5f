# mypy: ignore-errors
"""The force of a spring between masses of any models."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, WORK_AT, END = range(4)
"""Integers of an end; the second end's start at END. Of an end that is no mass: -1, offset of its place, -1."""
STIFFNESS_AT, DAMPING_AT, REST_AT, SPEEDS_AT = range(2 * END, 2 * END + 4)
"""From SPEEDS_AT on, for each end, the offset of a place's velocity in the floats, or -1."""


@kernel(TERM, inner=True)
def spring(t, y, rate, floats, ints):
    """Adds the force on both ends, and to the work the damping's power (half for each) and that of a prescribed end."""
    a, b = ints[POSITION_AT], ints[END + POSITION_AT]
    va, vb = ints[VELOCITY_AT], ints[END + VELOCITY_AT]
    dx = (y[b] if b >= 0 else floats[vb]) - (y[a] if a >= 0 else floats[va])
    dy = (y[b + 1] if b >= 0 else floats[vb + 1]) - (y[a + 1] if a >= 0 else floats[va + 1])
    dz = (y[b + 2] if b >= 0 else floats[vb + 2]) - (y[a + 2] if a >= 0 else floats[va + 2])
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return
    dx, dy, dz = dx / length, dy / length, dz / length
    ua, ub = ints[SPEEDS_AT], ints[SPEEDS_AT + 1]
    if a >= 0:
        leading = dx * y[va] + dy * y[va + 1] + dz * y[va + 2]
    else:
        leading = dx * floats[ua] + dy * floats[ua + 1] + dz * floats[ua + 2]
    if b >= 0:
        following = dx * y[vb] + dy * y[vb + 1] + dz * y[vb + 2]
    else:
        following = dx * floats[ub] + dy * floats[ub + 1] + dz * floats[ub + 2]
    opening = following - leading
    damping = floats[ints[DAMPING_AT]]
    pull = floats[ints[STIFFNESS_AT]] * (length - floats[ints[REST_AT]]) + damping * opening
    lost = damping * opening * opening
    if a >= 0:
        rate[va] += pull * dx
        rate[va + 1] += pull * dy
        rate[va + 2] += pull * dz
        rate[ints[WORK_AT]] += 0.5 * lost if b >= 0 else lost - pull * following
    if b >= 0:
        rate[vb] -= pull * dx
        rate[vb + 1] -= pull * dy
        rate[vb + 2] -= pull * dz
        rate[ints[END + WORK_AT]] += 0.5 * lost if a >= 0 else lost + pull * leading
