# mypy: ignore-errors
"""The derivatives of forces of 1/r^2 between all masses."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.nbody import layout
from sceneql.nbody.direct_kernels import BODIES
from sceneql.nbody.shared_masses_kernels import gather
from sceneql.nbody.weights_kernels import weights
from sceneql.system.signatures_kernels import TERM


@kernel(TERM)
def direct(t, y, entries, floats, ints):
    """A block of 3x3 for every two bodies (i, j), row by row: c w_i w_j (1/q^3 - 3 d d/q^5), subtracted at (i, i).

    q^2 = d^2 + softening^2.
    """
    n, at, weight = ints[BODIES], ints[layout.POINTS], ints[layout.WEIGHTS]
    gather(y, floats, ints, BODIES, at)
    weights(floats, ints, BODIES, weight)
    constant = ints[layout.SIGN] * floats[ints[layout.CONSTANT]]
    soft = floats[ints[layout.SOFTENING]] * floats[ints[layout.SOFTENING]]
    for i in range(n):
        own = 9 * (n * i + i)
        for j in range(n):
            dx = floats[at + j] - floats[at + i]
            dy = floats[at + n + j] - floats[at + n + i]
            dz = floats[at + 2 * n + j] - floats[at + 2 * n + i]
            square = dx * dx + dy * dy + dz * dz
            if square == 0.0:
                continue
            square += soft
            c = constant * floats[weight + i] * floats[weight + j] / (square * math.sqrt(square))
            for a in range(3):
                da = dx if a == 0 else (dy if a == 1 else dz)
                for b in range(3):
                    db = dx if b == 0 else (dy if b == 1 else dz)
                    slope = c * ((1.0 if a == b else 0.0) - 3.0 * da * db / square)
                    entries[9 * (n * i + j) + 3 * a + b] += slope
                    entries[own + 3 * a + b] -= slope
