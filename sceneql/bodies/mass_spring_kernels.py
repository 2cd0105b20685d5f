# mypy: ignore-errors
"""The forces of springs."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, WORK_AT, BLOCKS_AT, STIFFNESS_AT, DAMPING_AT, COUNT, PAIRS_AT = range(8)
"""From PAIRS_AT on the two masses of each spring."""

BLOCK = 5
"""Floats of a spring: rest length, stiffness, its part of the model's stiffness, damping, its part of the model's."""


@kernel(TERM, inner=True)
def springs(t, y, rate, floats, ints):
    """Adds -(k (L - L0) + c dL/dt) along each spring, and the dampers' power c (dL/dt)^2 to the work.

    A spring of length 0 pulls nowhere, by symmetry.
    """
    position_at, velocity_at, work_at, blocks_at = ints[POSITION_AT], ints[VELOCITY_AT], ints[WORK_AT], ints[BLOCKS_AT]
    model_stiffness, model_damping = floats[ints[STIFFNESS_AT]], floats[ints[DAMPING_AT]]
    power = 0.0
    for s in range(ints[COUNT]):
        a, b = 3 * ints[PAIRS_AT + 2 * s], 3 * ints[PAIRS_AT + 2 * s + 1]
        block = blocks_at + BLOCK * s
        k = floats[block + 1] + floats[block + 2] * model_stiffness
        c = floats[block + 3] + floats[block + 4] * model_damping
        dx = y[position_at + b] - y[position_at + a]
        dy = y[position_at + b + 1] - y[position_at + a + 1]
        dz = y[position_at + b + 2] - y[position_at + a + 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        if length == 0.0:
            continue
        dx, dy, dz = dx / length, dy / length, dz / length
        force = k * (length - floats[block])
        if c != 0.0:
            speed = (y[velocity_at + b] - y[velocity_at + a]) * dx
            speed += (y[velocity_at + b + 1] - y[velocity_at + a + 1]) * dy
            speed += (y[velocity_at + b + 2] - y[velocity_at + a + 2]) * dz
            force += c * speed
            power += c * speed * speed
        rate[velocity_at + a] += force * dx
        rate[velocity_at + a + 1] += force * dy
        rate[velocity_at + a + 2] += force * dz
        rate[velocity_at + b] -= force * dx
        rate[velocity_at + b + 1] -= force * dy
        rate[velocity_at + b + 2] -= force * dz
    rate[work_at] += power
