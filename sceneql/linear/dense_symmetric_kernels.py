# mypy: ignore-errors
"""Factorization of small dense symmetric positive definite matrices, without pivoting.

Matrices are n x n, row by row in flat arrays (which may be longer), of which the upper half is read. A = U^T D^-1 U,
with the reciprocals of the pivots D on U's diagonal. Source: Golub & Van Loan, Matrix Computations (2013), 4.1.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, F, N

FACTOR = types.boolean(A, N, F)
SOLVE = types.void(A, N, A)


@lean(FACTOR, inner=True)
def factor(a, n, least):
    """Factor in place; False where a pivot is not above the part ``least`` of its diagonal, or is not finite."""
    for k in range(n):
        # Of row k of the matrix the rows of U before it are subtracted only now: its diagonal is still there.
        row = a[k * n + k : (k + 1) * n]
        smallest = least * row[0]
        for i in range(k):
            above = a[i * n + k : (i + 1) * n]
            weight = above[0] * a[i * n + i]
            if weight != 0.0:
                for j in range(row.size):
                    row[j] -= weight * above[j]
        if not smallest < row[0] < math.inf:
            return False
        row[0] = 1.0 / row[0]
    return True


@lean(SOLVE, inner=True)
def solve(a, n, b):
    """Solve a x = b by the factors of ``factor``; x takes the place of b (n,)."""
    for k in range(n):
        row, rest = a[k * n + k : (k + 1) * n], b[k:n]
        value = rest[0] * row[0]
        rest[0] = value
        for j in range(1, row.size):
            rest[j] -= value * row[j]
    for k in range(n - 1, -1, -1):
        row, rest = a[k * n + k : (k + 1) * n], b[k:n]
        total = 0.0
        for j in range(1, row.size):
            total += row[j] * rest[j]
        rest[0] -= total * row[0]
