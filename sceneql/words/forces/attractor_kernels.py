# mypy: ignore-errors
"""The force of an attractor."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, MASS_AT, POINT_AT, STRENGTH_AT, SHAPE_AT = range(7)
"""At SHAPE_AT: exponent p, softening [m]."""


@kernel(TERM, inner=True)
def attractor(t, y, rate, floats, ints):
    """Adds m strength d / rho^(p+1), d towards the point, rho^2 = |d|^2 + softening^2."""
    position_at, velocity_at, count, mass_at = ints[POSITION_AT], ints[VELOCITY_AT], ints[COUNT], ints[MASS_AT]
    px, py, pz = floats[ints[POINT_AT]], floats[ints[POINT_AT] + 1], floats[ints[POINT_AT] + 2]
    strength = floats[ints[STRENGTH_AT]]
    p, softening = floats[ints[SHAPE_AT]], floats[ints[SHAPE_AT] + 1]
    for k in range(count):
        at = position_at + 3 * k
        dx, dy, dz = px - y[at], py - y[at + 1], pz - y[at + 2]
        square = dx * dx + dy * dy + dz * dz
        if square == 0.0:
            continue
        square += softening * softening
        rho = math.sqrt(square)
        scale = floats[mass_at + k] * strength
        scale /= square * rho if p == 2.0 else rho ** (p + 1.0)
        at = velocity_at + 3 * k
        rate[at] += scale * dx
        rate[at + 1] += scale * dy
        rate[at + 2] += scale * dz
