# mypy: ignore-errors
"""The energy of a spring between masses of any models."""

import math

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import ENERGY
from sceneql.words.forces.spring_kernels import END, POSITION_AT, REST_AT, STIFFNESS_AT, VELOCITY_AT


@lean(ENERGY, inner=True)
def energy(t, y, floats, ints):
    """Half of stiffness stretch^2 [J]."""
    total = 0.0
    for c in range(3):
        away = 0.0
        for end in range(2):
            at, place = ints[END * end + POSITION_AT], ints[END * end + VELOCITY_AT]
            away = (y[at + c] if at >= 0 else floats[place + c]) - away
        total += away * away
    stretch = math.sqrt(total) - floats[ints[REST_AT]]
    return 0.5 * floats[ints[STIFFNESS_AT]] * stretch * stretch
