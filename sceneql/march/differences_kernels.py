# mypy: ignore-errors
"""An island's Jacobian by differences, where the slopes of a term are not known."""

import math

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.system.signatures_kernels import JACOBIAN

ROUNDING = 2.2e-16


@lean(JACOBIAN)
def differences(functions, t, y, values, floats, ints):
    """The full Jacobian by forward differences; increments as in RADAU5 (Hairer & Wanner 1996, IV.8).

    ``values``: (n * n,) row by row, then 3n of scratch.
    """
    rate = rate_at(functions[AT_RATE])
    n = y.size
    moved = values[n * n : n * n + n]
    first = values[n * n + n : n * n + 2 * n]
    other = values[n * n + 2 * n : n * n + 3 * n]
    for k in range(n):
        moved[k] = y[k]
    rate(t, y, first, floats, ints)
    for j in range(n):
        moved[j] = y[j] + math.sqrt(ROUNDING * max(1e-5, abs(y[j])))
        move = moved[j] - y[j]
        rate(t, moved, other, floats, ints)
        moved[j] = y[j]
        for i in range(n):
            values[i * n + j] = (other[i] - first[i]) / move
