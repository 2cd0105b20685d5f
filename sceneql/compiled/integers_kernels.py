# mypy: ignore-errors
"""Arrays of integers made in kernels."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import I, N


@kernel(I(N, N), inner=True)
def filled(count, value):
    """An array of equal integers."""
    made = np.empty(count, dtype=np.int64)
    for k in range(count):
        made[k] = value
    return made


@kernel(I(I, N, N), inner=True)
def longer(source, count, size):
    """An array of so many integers that begins with the first ones of another."""
    made = np.empty(size, dtype=np.int64)
    for k in range(count):
        made[k] = source[k]
    return made
