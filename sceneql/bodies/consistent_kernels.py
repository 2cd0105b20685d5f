# mypy: ignore-errors
"""The closing term of masses whose inertia is a sparse matrix."""

from sceneql.compiled.kernels import lean
from sceneql.linear.multifrontal.solve_kernels import solve_symmetric
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, FACTORS_AT, FACTORS, WORK_AT, WORK, HELD_AT, PLAN = range(9)
"""COUNT entries of velocities; from PLAN on the plan of the factorization (linear/multifrontal)."""


@lean(TERM, inner=True)
def close(t, y, rate, floats, ints):
    """Newtons in ``rate`` become accelerations, by the factors of the inertia; a held entry has rate 0."""
    position, velocity, count = ints[POSITION_AT], ints[VELOCITY_AT], ints[COUNT]
    held = floats[ints[HELD_AT] : ints[HELD_AT] + count]
    change, moves = rate[velocity : velocity + count], rate[position : position + count]
    for k in range(count):
        free = held[k] == 0.0
        moves[k] = y[velocity + k] if free else 0.0
        change[k] = change[k] if free else 0.0
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    solve_symmetric(ints[PLAN:], factors, change, floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]])
