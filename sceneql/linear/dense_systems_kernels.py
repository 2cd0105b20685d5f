# mypy: ignore-errors
"""dense_kernels.py as a linear solver (solver_kernels.py)."""

from sceneql.compiled.kernels import lean
from sceneql.linear.dense_kernels import factor, solve
from sceneql.linear.solver_kernels import FACTOR_SYSTEM, SOLVE_SYSTEM


@lean(FACTOR_SYSTEM)
def factor_system(plan, values, factors, work, symmetric):
    """Factor; ``plan``: the number of unknowns, then room for the pivots."""
    n = plan[0]
    for k in range(n * n):
        factors[k] = values[k]
    return factor(factors, n, plan[1:])


@lean(SOLVE_SYSTEM)
def solve_system(plan, values, factors, b, work, symmetric):
    """Solve by the factors."""
    solve(factors, plan[0], plan[1:], b)
    return True
