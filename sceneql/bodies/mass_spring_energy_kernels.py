# mypy: ignore-errors
"""The energy of springs, in a module of its own, since most runs need not compile it."""

import math

from numba import types

from sceneql.bodies.mass_spring_kernels import BLOCK, BLOCKS_AT, COUNT, PAIRS_AT, POSITION_AT, STIFFNESS_AT
from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import ENERGY, A, N


@kernel(types.float64(A, N, A, N, N, types.int64[:, ::1]))
def energy(y, position_at, floats, blocks_at, stiffness_at, pairs):
    """Sum of k (L - L0)^2 / 2 [J]."""
    total = 0.0
    for s in range(len(pairs)):
        a, b = position_at + 3 * pairs[s, 0], position_at + 3 * pairs[s, 1]
        block = blocks_at + BLOCK * s
        dx, dy, dz = y[b] - y[a], y[b + 1] - y[a + 1], y[b + 2] - y[a + 2]
        stretch = math.sqrt(dx * dx + dy * dy + dz * dz) - floats[block]
        total += 0.5 * (floats[block + 1] + floats[block + 2] * floats[stiffness_at]) * stretch * stretch
    return total


@kernel(ENERGY, inner=True)
def potential(t, y, floats, ints):
    """`energy`, of the term's integers."""
    pairs = ints[PAIRS_AT : PAIRS_AT + 2 * ints[COUNT]].reshape(-1, 2)
    return energy(y, ints[POSITION_AT], floats, ints[BLOCKS_AT], ints[STIFFNESS_AT], pairs)
