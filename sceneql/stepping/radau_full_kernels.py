# mypy: ignore-errors
"""Radau's linear systems by full LU factorizations, a real and a complex one: for up to some hundred unknowns.

``plan``: the plan of eliminated_systems_kernels.py for m entries left, then m + m pivots. ``store``: three matrices m x
m, two vectors.
"""

from sceneql.compiled.kernels import lean
from sceneql.stepping.eliminated_systems_kernels import LEFT, factor_pair, factor_real, solve_pair, solve_real
from sceneql.stepping.radau_systems_kernels import ALPHA, BETA, FACTOR_STAGES, FILTER, REAL, SOLVE_STAGES


@lean(FACTOR_STAGES)
def factor(plan, h, values, rows, store):
    """Factor both systems."""
    m, at = plan[LEFT], plan.size - 2 * plan[LEFT]
    square = m * m
    if not factor_real(REAL / h, values, plan, store[:square], plan[at : at + m]):
        return False
    re, im = store[square : 2 * square], store[2 * square : 3 * square]
    return factor_pair(ALPHA / h, BETA / h, values, plan, re, im, plan[at + m :])


@lean(FILTER)
def solve_one(plan, h, values, rows, store, r):
    """Solve the real system."""
    m, at = plan[LEFT], plan.size - 2 * plan[LEFT]
    solve_real(REAL / h, values, plan, store[: m * m], plan[at : at + m], store[3 * m * m :], r)
    return True


@lean(SOLVE_STAGES)
def solve(plan, h, values, rows, store, weights, r):
    """Solve both systems."""
    m, n = plan[LEFT], weights.size
    square = m * m
    re, im = store[square : 2 * square], store[2 * square : 3 * square]
    spare, other = store[3 * square : 3 * square + m], store[3 * square + m :]
    solve_one(plan, h, values, rows, store, r[:n])
    solve_pair(ALPHA / h, BETA / h, values, plan, re, im, plan[plan.size - m :], spare, other, r[n : 2 * n], r[2 * n :])
    return True
