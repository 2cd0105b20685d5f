# mypy: ignore-errors
"""Dense LU factorization with partial pivoting of small matrices.

Matrices are n x n, row by row in flat arrays (which may be longer). Source: Golub & Van Loan, Matrix Computations
(2013), algorithm 3.4.1, with whole rows exchanged.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, I, N

FACTOR = types.boolean(A, N, I)
SOLVE = types.void(A, N, I, A)


@lean(FACTOR)
def factor(a, n, pivots):
    """a = P^T L U in place: U with the reciprocals of its diagonal, L below it; False where a is singular.

    ``pivots`` (n,): the row that was exchanged with row k in step k.
    """
    for k in range(n):
        row = k * n
        best = k
        size = abs(a[row + k])
        for i in range(k + 1, n):
            other = abs(a[i * n + k])
            if other > size:
                size = other
                best = i
        pivots[k] = best
        if not 0.0 < size < math.inf:
            return False
        if best != k:
            swap = best * n
            for j in range(n):
                a[row + j], a[swap + j] = a[swap + j], a[row + j]
        inverse = 1.0 / a[row + k]
        a[row + k] = inverse
        for i in range(k + 1, n):
            below = i * n
            if a[below + k] != 0.0:
                factor = a[below + k] * inverse
                a[below + k] = factor
                for j in range(k + 1, n):
                    a[below + j] -= factor * a[row + j]
    return True


@lean(SOLVE)
def solve(a, n, pivots, b):
    """Solve a x = b by the factors of ``factor``; x takes the place of b (n,)."""
    for k in range(n):
        best = pivots[k]
        value = b[best]
        b[best] = b[k]
        b[k] = value
    for i in range(n):
        value = b[i]
        for j in range(i):
            value -= a[i * n + j] * b[j]
        b[i] = value
    for i in range(n - 1, -1, -1):
        value = b[i]
        for j in range(i + 1, n):
            value -= a[i * n + j] * b[j]
        b[i] = value * a[i * n + i]
