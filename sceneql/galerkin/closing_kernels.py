# mypy: ignore-errors
"""The closing terms of fields on elements: what flows in becomes a rate by the mass."""

from sceneql.compiled.kernels import lean
from sceneql.linear.multifrontal.solve_kernels import solve_symmetric
from sceneql.system.signatures_kernels import TERM

AT, COUNT, VOLUMES = range(3)
"""Integers of `lumped`."""
FACTORS_AT, FACTORS, WORK_AT, WORK, PLAN = range(2, 7)
"""Of `consistent`, besides AT and COUNT: from PLAN on the plan of the factorization (linear/multifrontal)."""


@lean(TERM, inner=True)
def lumped(t, y, rate, floats, ints):
    """By the integrals of the functions."""
    for k in range(ints[COUNT]):
        rate[ints[AT] + k] /= floats[ints[VOLUMES] + k]


@lean(TERM, inner=True)
def consistent(t, y, rate, floats, ints):
    """By the factors of the matrix."""
    own = rate[ints[AT] : ints[AT] + ints[COUNT]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    solve_symmetric(ints[PLAN:], factors, own, floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]])


@lean(TERM, inner=True)
def nothing(t, y, entries, floats, ints):
    """The closing terms have no derivatives of their own: linear systems have the mass (Assembly.capacity)."""
