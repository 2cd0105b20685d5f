# mypy: ignore-errors
"""The derivatives of the force of an attractor."""

import math

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import attractor_kernels as force


@lean(TERM, inner=True)
def attractor(t, y, entries, floats, ints):
    """m strength ((p + 1) d d / rho^(p+3) - 1 / rho^(p+1)) of each mass, a block of 3x3 by its position."""
    strength = floats[ints[force.STRENGTH_AT]]
    p, softening = floats[ints[force.SHAPE_AT]], floats[ints[force.SHAPE_AT] + 1]
    for k in range(ints[force.COUNT]):
        at = ints[force.POSITION_AT] + 3 * k
        square = 0.0
        for i in range(3):
            away = floats[ints[force.POINT_AT] + i] - y[at + i]
            square += away * away
        if square == 0.0:
            continue
        square += softening * softening
        scale = floats[ints[force.MASS_AT] + k] * strength / math.sqrt(square) ** (p + 1.0)
        for i in range(3):
            entries[9 * k + 4 * i] -= scale
            bend = scale * (p + 1.0) / square * (floats[ints[force.POINT_AT] + i] - y[at + i])
            for j in range(3):
                entries[9 * k + 3 * i + j] += bend * (floats[ints[force.POINT_AT] + j] - y[at + j])
