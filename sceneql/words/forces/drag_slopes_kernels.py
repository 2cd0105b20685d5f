# mypy: ignore-errors
"""The derivatives of the force of drag."""

import math

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import drag_kernels as force


@lean(TERM, inner=True)
def drag(t, y, entries, floats, ints):
    """-(a + b |v|) - b v v/|v| of each mass, a block of 3x3 by its velocity."""
    linear, quadratic = floats[ints[force.LINEAR_AT]], floats[ints[force.QUADRATIC_AT]]
    for k in range(ints[force.COUNT]):
        at = ints[force.VELOCITY_AT] + 3 * k
        size = math.sqrt(y[at] * y[at] + y[at + 1] * y[at + 1] + y[at + 2] * y[at + 2])
        bend = quadratic / size if size > 0.0 else 0.0
        for i in range(3):
            entries[9 * k + 4 * i] -= linear + quadratic * size
            for j in range(3):
                entries[9 * k + 3 * i + j] -= bend * y[at + i] * y[at + j]
