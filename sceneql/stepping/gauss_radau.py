"""Everhart's method of order 15: coefficients derived from its nodes, and its stability on linear systems.

In a step of length h, at s = (t - t0)/h, the rate is the polynomial f0 + b1 s + b2 s^2 + ... + b7 s^7 that interpolates
the rate at eight Gauss-Radau nodes. Its Newton form f0 + g1 s + g2 s (s - s1) + ... is built up node by node.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import comb, inf
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.frame import Floats

NODES = (
    0.05626256053692214646,
    0.18024069173689236499,
    0.35262471711316963737,
    0.54715362633055538300,
    0.73421017721541053152,
    0.88532094683909576809,
    0.97752061356128750189,
)
"""The roots of (P7 + P8)(2 s - 1) / s, P the Legendre polynomials; the first node is 0 (Radau 1880)."""
DEGREE = len(NODES)
CONTRACTION = 0.3
"""Contraction per pass above which the iteration counts as divergent: 12 passes at this factor gain 6 digits."""


@cache
def settings() -> tuple[float, ...]:
    """The settings of the kernels, in this order.

    8 ends of integration; the weights of the Newton form there, (8, 7) each, integrated once and twice, divided by the
    end and by its square; three (7, 7) matrices: inverse differences of the nodes, Newton form to powers, powers to
    Newton form; and the binomials (7, 7) that shift a polynomial to the next step.
    """
    ends = (*NODES, 1.0)
    powers = range(1, DEGREE + 1)
    tables = (
        [[float(integral(row, s, 1)) for row in to_powers(Fraction)] for s in ends],
        [[float(integral(row, s, 2)) for row in to_powers(Fraction)] for s in ends],
        inverse_differences(),
        to_powers(),
        to_newton(),
        [[float(comb(k, j)) for k in powers] for j in powers],
    )
    return (*ends, *(number for table in tables for row in table for number in row))


def inverse_differences() -> list[list[float]]:
    """Row i: 1/(s_i - s_j) for all earlier nodes s_j, beginning with the one at 0."""
    places = (0.0, *NODES)
    return [[1.0 / (places[i] - places[j]) if j < i else 0.0 for j in range(DEGREE)] for i in range(1, DEGREE + 1)]


def to_powers(number: type[Any] = float) -> list[list[Any]]:
    """Row i: the coefficients of s (s - s1) ... (s - s_i) at s, s^2, ..."""
    rows = [[number(1), *(number(0),) * (DEGREE - 1)]]
    for node in NODES[:-1]:
        rows.append([(rows[-1][k - 1] if k else number(0)) - number(node) * rows[-1][k] for k in range(DEGREE)])
    return rows


def integral(row: list[Fraction], end: float, times: int) -> Fraction:
    """Exact integral of a polynomial up to ``end``, once or twice (``times``), divided by end^times.

    ``row``: the coefficients at s, s^2, ...
    """
    s = Fraction(end)
    return sum(
        (c * s**k * Fraction(1, k + 1 if times == 1 else (k + 1) * (k + 2)) for k, c in enumerate(row, 1)), Fraction()
    )


def to_newton() -> list[list[float]]:
    """Row i: s^(i+1) in the Newton form, the inverse of `to_powers`, by sums of products of nodes."""
    rows = [[1.0, *(0.0,) * (DEGREE - 1)]]
    for _ in range(DEGREE - 1):
        rows.append([(rows[-1][k - 1] if k else 0.0) + NODES[k] * rows[-1][k] for k in range(DEGREE)])
    return rows


def growth(jacobian: Floats, partner: Any, step: float) -> float:
    """Spectral radius of a converged step of y' = jacobian y; ``partner``: pairs as in `Solver.growth`.

    Infinite where the iteration for the polynomial does not converge.
    """
    import numpy as np

    matrix, of = np.asarray(jacobian, dtype=float), np.asarray(partner)
    n = len(matrix)
    positions = np.flatnonzero(of >= 0)
    pushed = (of < 0).astype(float)[:, None]
    divisors, powers = np.array(inverse_differences()), np.array(to_powers())

    def state(s: float, y: Any, b: Any) -> Any:
        """(n, columns) states at s inside the step.

        ``y`` (n, columns): at the step's start; ``b`` (7, n, columns): the polynomial's coefficients.
        """
        f0 = pushed * (matrix @ y)
        change = f0 + sum(b[k] * s ** (k + 1) / (k + 2) for k in range(DEGREE))
        twice = f0 / 2 + sum(b[k] * s ** (k + 1) / ((k + 2) * (k + 3)) for k in range(DEGREE))
        result = y + step * s * change
        result[positions] = y[positions] + step * s * (y + step * s * twice)[of[positions]]
        return result

    def sweep(y: Any, b: Any) -> Any:
        """The polynomial's coefficients after one pass over the nodes."""
        b = b.copy()
        newton = np.tensordot(np.array(to_newton()).T, b, 1)
        for i, s in enumerate(NODES):
            value = pushed * (matrix @ (state(s, y, b) - y)) * divisors[i, 0]
            for j in range(1, i + 1):
                value = (value - newton[j - 1]) * divisors[i, j]
            b += powers[i][:, None, None] * (value - newton[i])
            newton[i] = value
        return b

    size = DEGREE * n
    units = np.eye(size).reshape(DEGREE, n, size)
    again = sweep(np.zeros((n, size)), units).reshape(size, size)
    if np.abs(np.linalg.eigvals(again)).max(initial=0.0) > CONTRACTION:
        return inf
    once = sweep(np.eye(n), np.zeros((DEGREE, n, n))).reshape(size, n)
    b = np.linalg.solve(np.eye(size) - again, once).reshape(DEGREE, n, n)
    return float(np.abs(np.linalg.eigvals(state(1.0, np.eye(n), b))).max(initial=0.0))
