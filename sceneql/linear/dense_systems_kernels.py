# mypy: ignore-errors
"""dense_kernels.py as a linear solver (solver_kernels.py)."""

from sceneql.compiled.kernels import lean
from sceneql.linear.dense_kernels import factor, solve
from sceneql.linear.solver_kernels import FACTOR_SYSTEM, NEGATIVES, SOLVE_SYSTEM


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


@lean(NEGATIVES)
def negatives(plan, values, factors, work):
    """As many as negative pivots of L D L^T, without exchanges; a pivot of 0 counts as a small positive one.

    ``work`` (n n,).
    """
    n, a = plan[0], work
    size = 0.0
    for k in range(n * n):
        a[k] = values[k]
        size = max(size, abs(a[k]))
    found = 0
    for k in range(n):
        pivot = a[k * n + k]
        if pivot < 0.0:
            found += 1
        elif pivot == 0.0:
            pivot = 1e-16 * size
        for i in range(k + 1, n):
            part = a[i * n + k] / pivot
            if part != 0.0:
                for j in range(k + 1, n):
                    a[i * n + j] -= part * a[k * n + j]
    return found
