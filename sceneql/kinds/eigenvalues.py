"""Eigenvalues of small matrices in plain Python, for bounds that `check` gives before the run."""

from __future__ import annotations

import math
from collections.abc import Sequence

Rows = Sequence[Sequence[complex]]

TURNS = 60
"""Most iterations for each eigenvalue; three do as a rule."""
ROUNDING = 2.3e-16


def eigenvalues(matrix: Rows) -> list[complex]:
    """Eigenvalues of an (n, n) matrix by shifted QR steps on its Hessenberg form (Francis 1961; Golub & Van Loan, 7.4).

    NaN where an entry is not finite or the iteration does not converge.
    """
    rows = [[complex(entry) for entry in row] for row in matrix]
    if not all(math.isfinite(entry.real) and math.isfinite(entry.imag) for row in rows for entry in row):
        return [complex(math.nan)] * len(rows)
    _reduce(rows)
    found: list[complex] = []
    size, turns = len(rows), 0
    while size > 0:
        low = size - 1
        while low > 0 and abs(rows[low][low - 1]) > ROUNDING * (abs(rows[low][low]) + abs(rows[low - 1][low - 1])):
            low -= 1
        if low == size - 1:
            found.append(rows[low][low])
            size, turns = size - 1, 0
        elif turns == TURNS:
            return found + [complex(math.nan)] * size
        else:
            turns += 1
            _step(rows, low, size, stuck=turns % 11 == 0)
    return found


def _reduce(rows: list[list[complex]]) -> None:
    """Reduce to Hessenberg form in place, by elimination with pivots."""
    n = len(rows)
    for k in range(1, n - 1):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k - 1]))
        if rows[pivot][k - 1] == 0.0:
            continue
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for row in rows:
            row[k], row[pivot] = row[pivot], row[k]
        for i in range(k + 1, n):
            factor = rows[i][k - 1] / rows[k][k - 1]
            if factor:
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
                for row in rows:
                    row[k] += factor * row[i]
            rows[i][k - 1] = 0j


def _step(rows: list[list[complex]], low: int, size: int, stuck: bool) -> None:
    """One QR step on rows low..size-1, shifted by the eigenvalue of the last 2x2 block nearer to its last entry."""
    a, b = rows[size - 2][size - 2 : size]
    c, d = rows[size - 1][size - 2 : size]
    half = 0.5 * (a - d)
    root = (half * half + b * c) ** 0.5
    ends = (d + half + root, d + half - root)
    shift = abs(c) + d if stuck else min(ends, key=lambda value: abs(value - d))
    for k in range(low, size):
        rows[k][k] -= shift
    turned = []
    for k in range(low, size - 1):
        x, y = rows[k][k], rows[k + 1][k]
        length = math.hypot(abs(x), abs(y))
        cos, sin = (x / length, y / length) if length else (1.0 + 0j, 0j)
        turned.append((cos, sin))
        for j in range(k, size):
            p, q = rows[k][j], rows[k + 1][j]
            rows[k][j] = cos.conjugate() * p + sin.conjugate() * q
            rows[k + 1][j] = cos * q - sin * p
    for k, (cos, sin) in enumerate(turned, low):
        for i in range(low, min(k + 2, size)):
            p, q = rows[i][k], rows[i][k + 1]
            rows[i][k] = p * cos + q * sin
            rows[i][k + 1] = q * cos.conjugate() - p * sin.conjugate()
    for k in range(low, size):
        rows[k][k] += shift
