# mypy: ignore-errors
"""Damping of nodes in proportion to their momentum."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM

VELOCITY_AT, WORK_AT, COUNT, MASS_AT, DAMPING_AT = range(5)


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds -damping m v, and its power to the work."""
    for k in range(3 * ints[COUNT]):
        at = ints[VELOCITY_AT] + k
        lost = floats[ints[DAMPING_AT]] * floats[ints[MASS_AT] + k // 3] * y[at]
        rate[at] -= lost
        rate[ints[WORK_AT]] += lost * y[at]


@lean(TERM, inner=True)
def slopes(t, y, entries, floats, ints):
    """Its derivative by the velocities: of each node nine entries, a 3x3 block."""
    for k in range(3 * ints[COUNT]):
        entries[9 * (k // 3) + 4 * (k % 3)] -= floats[ints[DAMPING_AT]] * floats[ints[MASS_AT] + k // 3]
