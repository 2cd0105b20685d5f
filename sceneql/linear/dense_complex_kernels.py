# mypy: ignore-errors
"""Dense LU factorization with partial pivoting of small complex matrices: as dense_kernels.py.

A matrix is two arrays, so that the loops vectorize.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, I, N

FACTOR_COMPLEX = types.boolean(A, A, N, I)
SOLVE_COMPLEX = types.void(A, A, N, I, A, A)


@lean(FACTOR_COMPLEX)
def factor_complex(a, b, n, pivots):
    """Factor the matrix a + i b like ``dense_kernels.factor``; the pivot is the largest in |Re| + |Im|."""
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
