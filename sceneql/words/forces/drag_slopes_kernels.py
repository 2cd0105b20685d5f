# mypy: ignore-errors
"""The derivatives of the force of drag."""

import math

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def drag(t, y, entries, floats, ints):
    """-(a + b |v|) - b v v/|v| of each mass, a block of 3x3 by its velocity. ints: those of drag_kernels.drag."""
    linear, quadratic = floats[ints[4]], floats[ints[5]]
    for k in range(ints[1]):
        at = ints[0] + 3 * k
        size = math.sqrt(y[at] * y[at] + y[at + 1] * y[at + 1] + y[at + 2] * y[at + 2])
        bend = quadratic / size if size > 0.0 else 0.0
        for i in range(3):
            entries[9 * k + 4 * i] -= linear + quadratic * size
            for j in range(3):
                entries[9 * k + 3 * i + j] -= bend * y[at + i] * y[at + j]
