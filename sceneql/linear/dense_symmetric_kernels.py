# mypy: ignore-errors
"""Factorization of small dense symmetric positive definite matrices, without pivoting.

Matrices are n x n, row by row in flat arrays, of which the upper half is read; rows begin ``stride`` >= n apart, a
multiple of 8, and behind the last one are 8 numbers more: lanes reach beyond rows, and overwrite the lower half. A =
U^T D^-1 U, with the reciprocals of the pivots D on U's diagonal. Source: Golub & Van Loan, Matrix Computations (2013),
4.1.
"""

import math

from numba import types

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean
from sceneql.compiled.lanes_kernels import fma, load, store
from sceneql.system.signatures_kernels import A, F, N

FACTOR = types.float64(A, N, N, F)
SOLVE = types.void(A, N, N, A)
LANES = 8


@lean(FACTOR, inner=True)
def factor(a, n, stride, least):
    """Factor in place; the least part of its diagonal that a pivot is, 0 if not above ``least`` or not finite."""
    widest()
    worst = 1.0
    for k in range(n):
        # Of row k of the matrix the rows of U before it are subtracted only now: its diagonal is still there.
        row = k * stride
        diagonal = a[row + k]
        j = k - k % LANES
        while j + LANES < n:
            sums, more = load(a, row + j), load(a, row + j + LANES)
            for i in range(k):
                above = i * stride
                part = -(a[above + k] * a[above + i])
                sums, more = fma(part, load(a, above + j), sums), fma(part, load(a, above + j + LANES), more)
            store(a, row + j, sums)
            store(a, row + j + LANES, more)
            j += 2 * LANES
        if j < n:
            sums = load(a, row + j)
            for i in range(k):
                above = i * stride
                sums = fma(-(a[above + k] * a[above + i]), load(a, above + j), sums)
            store(a, row + j, sums)
        pivot = a[row + k]
        if not least * diagonal < pivot < math.inf:
            return 0.0
        a[row + k] = 1.0 / pivot
        worst = min(worst, pivot / diagonal)
    return worst


@lean(SOLVE, inner=True)
def solve(a, n, stride, b):
    """Solve a x = b by the factors of ``factor``; x takes the place of b (n,)."""
    for k in range(n):
        total = b[k]
        for i in range(k):  # the last one found comes last: all others are summed before it is known
            total -= a[i * stride + k] * b[i]
        b[k] = total * a[k * stride + k]
    for k in range(n - 1, -1, -1):
        total, row = 0.0, k * stride
        for j in range(n - 1, k, -1):
            total += a[row + j] * b[j]
        b[k] -= total * a[row + k]
