# mypy: ignore-errors
"""Damping of nodes in proportion to their momentum."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import ENERGY, TERM

VELOCITY_AT, WORK_AT, COUNT, DAMPING_AT, VALUES_AT, ROWS = range(6)
"""Offset of the values [kg] of the mass matrix; from ROWS on where each row begins, COUNT + 1, then columns (nodes)."""


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds -damping M v, and its power to the work."""
    columns = ROWS + ints[COUNT] + 1
    for n in range(ints[COUNT]):
        for c in range(3):
            momentum = 0.0
            for k in range(ints[ROWS + n], ints[ROWS + n + 1]):
                momentum += floats[ints[VALUES_AT] + k] * y[ints[VELOCITY_AT] + 3 * ints[columns + k] + c]
            lost = floats[ints[DAMPING_AT]] * momentum
            rate[ints[VELOCITY_AT] + 3 * n + c] -= lost
            rate[ints[WORK_AT]] += lost * y[ints[VELOCITY_AT] + 3 * n + c]


@lean(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """Its derivative by the velocities: of each value of the matrix nine entries, a 3x3 block."""
    for k in range(ints[ROWS + ints[COUNT]]):
        for c in range(3):
            entries[9 * k + 4 * c] -= floats[ints[DAMPING_AT]] * floats[ints[VALUES_AT] + k]


@lean(ENERGY, inner=True)
def potential(t, y, floats, ints):
    """It has none where nothing moves."""
    return 0.0
