# mypy: ignore-errors
"""Dense LU factorization with partial pivoting of small matrices, real and complex.

Matrices are n x n, row by row in flat arrays (which may be longer); a complex one is two arrays, so that the loops
vectorize. Source: Golub & Van Loan, Matrix Computations (2013), algorithm 3.4.1, with whole rows exchanged.
"""

import math

from numba import types

from sceneql.kernels import lean
from sceneql.simulation.linear.solver_kernels import FACTOR_SYSTEM, SOLVE_SYSTEM
from sceneql.system_kernels import A, I, N

FACTOR = types.boolean(A, N, I)
SOLVE = types.void(A, N, I, A)
FACTOR_COMPLEX = types.boolean(A, A, N, I)
SOLVE_COMPLEX = types.void(A, A, N, I, A, A)


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


@lean(FACTOR_COMPLEX)
def factor_complex(a, b, n, pivots):
    """Factor the matrix a + i b like ``factor``; the pivot is the largest in |Re| + |Im|."""
    for k in range(n):
        row = k * n
        best = k
        size = abs(a[row + k]) + abs(b[row + k])
        for i in range(k + 1, n):
            other = abs(a[i * n + k]) + abs(b[i * n + k])
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
                b[row + j], b[swap + j] = b[swap + j], b[row + j]
        scale = 1.0 / size
        re, im = a[row + k] * scale, b[row + k] * scale
        weight = scale / (re * re + im * im)
        re, im = re * weight, -im * weight
        a[row + k], b[row + k] = re, im
        for i in range(k + 1, n):
            below = i * n
            if a[below + k] != 0.0 or b[below + k] != 0.0:
                p = a[below + k] * re - b[below + k] * im
                q = a[below + k] * im + b[below + k] * re
                a[below + k], b[below + k] = p, q
                for j in range(k + 1, n):
                    a[below + j] -= p * a[row + j] - q * b[row + j]
                    b[below + j] -= p * b[row + j] + q * a[row + j]
    return True


@lean(SOLVE_COMPLEX)
def solve_complex(a, b, n, pivots, x, y):
    """Solve (a + i b) z = x + i y by the factors of ``factor_complex``; z takes the place of x + i y."""
    for k in range(n):
        best = pivots[k]
        re, im = x[best], y[best]
        x[best], y[best] = x[k], y[k]
        x[k], y[k] = re, im
    for i in range(n):
        re, im = x[i], y[i]
        for j in range(i):
            p, q = a[i * n + j], b[i * n + j]
            re -= p * x[j] - q * y[j]
            im -= p * y[j] + q * x[j]
        x[i], y[i] = re, im
    for i in range(n - 1, -1, -1):
        re, im = x[i], y[i]
        for j in range(i + 1, n):
            p, q = a[i * n + j], b[i * n + j]
            re -= p * x[j] - q * y[j]
            im -= p * y[j] + q * x[j]
        p, q = a[i * n + i], b[i * n + i]
        x[i], y[i] = re * p - im * q, re * q + im * p


@lean(FACTOR_SYSTEM)
def factor_system(plan, values, factors, work, symmetric):
    """`factor` as a linear solver has it; ``plan``: the number of unknowns, then room for the pivots."""
    n = plan[0]
    for k in range(n * n):
        factors[k] = values[k]
    return factor(factors, n, plan[1:])


@lean(SOLVE_SYSTEM)
def solve_system(plan, values, factors, b, work, symmetric):
    """`solve` likewise."""
    solve(factors, plan[0], plan[1:], b)
    return True
