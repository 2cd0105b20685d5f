# mypy: ignore-errors
"""The forces of springs."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

BLOCK = 5
"""Floats of a spring: rest length, stiffness, its part of the model's stiffness, damping, its part of the model's."""


@kernel(TERM, inner=True)
def springs(t, y, rate, floats, ints):
    """Adds -(k (L - L0) + c dL/dt) along each spring, and the dampers' power c (dL/dt)^2 to the work.

    ints: position_at, velocity_at, work_at, blocks_at, stiffness_at, damping_at, count, then the two masses of each.
    A spring of length 0 pulls nowhere, by symmetry.
    """
    position_at, velocity_at, work_at, blocks_at = ints[0], ints[1], ints[2], ints[3]
    model_stiffness, model_damping = floats[ints[4]], floats[ints[5]]
    power = 0.0
    for s in range(ints[6]):
        a, b = 3 * ints[7 + 2 * s], 3 * ints[8 + 2 * s]
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
