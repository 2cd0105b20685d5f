# mypy: ignore-errors
"""How many eigenvalues of a small symmetric matrix are negative (Sylvester's law of inertia)."""

from sceneql.compiled.kernels import lean
from sceneql.linear.solver_kernels import NEGATIVES


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
