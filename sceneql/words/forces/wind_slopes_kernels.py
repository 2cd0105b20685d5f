# mypy: ignore-errors
"""The derivatives of the force of moving air."""

import math

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import wind_kernels as force


@lean(TERM, inner=True)
def wind(t, y, entries, floats, ints):
    """-(a + b |w|) - b w w/|w| of each mass, a block of 3x3 by its velocity."""
    linear, quadratic = floats[ints[force.LINEAR_AT]], floats[ints[force.QUADRATIC_AT]]
    ux, uy, uz = force.air(t, floats, ints)
    for k in range(ints[force.COUNT]):
        at = ints[force.VELOCITY_AT] + 3 * k
        w = (y[at] - ux, y[at + 1] - uy, y[at + 2] - uz)
        size = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
        bend = quadratic / size if size > 0.0 else 0.0
        for i in range(3):
            entries[9 * k + 4 * i] -= linear + quadratic * size
            for j in range(3):
                entries[9 * k + 3 * i + j] -= bend * w[i] * w[j]
