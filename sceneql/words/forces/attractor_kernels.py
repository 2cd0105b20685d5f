# mypy: ignore-errors
"""The force of an attractor."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM


@kernel(TERM, inner=True)
def attractor(t, y, rate, floats, ints):
    """Adds m strength d / rho^(p+1), d towards the point, rho^2 = |d|^2 + softening^2.

    ints: position_at, velocity_at, count, mass_at, point_at, strength_at, shape_at (exponent p, softening).
    """
    position_at, velocity_at, count, mass_at = ints[0], ints[1], ints[2], ints[3]
    px, py, pz = floats[ints[4]], floats[ints[4] + 1], floats[ints[4] + 2]
    strength = floats[ints[5]]
    p, softening = floats[ints[6]], floats[ints[6] + 1]
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
