"""The fastest mode of an island at any moment of its run, by little more than a dozen evaluations of the rate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

    Partners = NDArray[int64]
    Rate = Callable[[float, Floats], Floats]
    """dy/dt (n,) at a time [s] and state."""

SMALL = 12
"""Entries of y up to which the whole Jacobian is found; above, the dimension of the Krylov space."""
MOVE = 1.5e-8
"""Relative size of differences: the root of the rounding unit."""


def dominant(rate_at: Rate, partner: Partners, t: float, y: Floats) -> complex:
    """The eigenvalue [1/s] of largest modulus of the rate's Jacobian at a state, the upper one of a pair.

    ``partner`` (n,): for a position entry of y the index of its velocity, else -1.
    Above SMALL entries by Arnoldi's iteration (Arnoldi 1951), which finds the outermost eigenvalues first.
    """
    n = len(y)
    rate = rate_at(t, y)
    if n <= SMALL:
        moves = MOVE * np.maximum(np.abs(y), 1e-3)
        columns = [(rate_at(t, y + move * unit) - rate) / move for move, unit in zip(moves, np.eye(n), strict=True)]
        matrix = np.column_stack(columns)
    else:
        scale = MOVE * max(1e-3, float(np.linalg.norm(y)))
        units = units_of(rate_at, partner, t, y, scale)
        basis = np.zeros((SMALL + 1, n))
        matrix = np.zeros((SMALL + 1, SMALL))
        start = np.random.Generator(np.random.Philox(1)).standard_normal(n)
        basis[0] = start / np.linalg.norm(start)
        size = 0
        for k in range(SMALL):
            product = (rate_at(t, y + scale * units * basis[k]) - rate) / (scale * units)
            for _ in range(2):  # once leaves what rounding put back, which grows from vector to vector
                along = basis[: k + 1] @ product
                matrix[: k + 1, k] += along
                product -= along @ basis[: k + 1]
            size = k + 1
            matrix[k + 1, k] = left = np.linalg.norm(product)
            if not left > 1e-10 * np.abs(matrix).max():
                break
            basis[k + 1] = product / left
        matrix = matrix[:size, :size]
    if not np.isfinite(matrix).all():
        return 0j
    values = np.linalg.eigvals(matrix)
    found = complex(values[int(np.argmax(np.abs(values) + 1e-3 * np.abs(values.imag)))])  # of as fast ones, what swings
    return complex(found.real, abs(found.imag))


def units_of(rate_at: Rate, partner: Partners, t: float, y: Floats, scale: float) -> Floats:
    """Units (n,) in which positions and velocities of stiff springs are of one size.

    Without them the matrix is far from normal, and Ritz values of a small Krylov space are far from its eigenvalues.
    """
    units = np.ones(len(y))
    positions = np.flatnonzero(partner >= 0)
    if len(positions):
        velocities = partner[positions]
        moved = y.copy()
        # Uneven moves: where all masses are moved alike, the springs between them do not pull.
        moved[positions] += scale * np.random.Generator(np.random.Philox(2)).standard_normal(len(positions))
        pull = (rate_at(t, moved) - rate_at(t, y))[velocities] / scale
        square = float(np.sqrt(np.mean(pull * pull)))
        units[velocities] = np.sqrt(square) if 0.0 < square < np.inf else 1.0
    return units


def boundary(coefficients: tuple[float, ...], direction: complex) -> float:
    """Largest r with |R(s u)| <= 1 for s up to r, u the direction; R a polynomial, its coefficient of z^0 first."""
    if direction.real > 0:
        direction = complex(0.0, abs(direction))
    lengths = np.geomspace(0.1, 50.0, 400)
    growth = np.abs(np.polyval(coefficients[::-1], lengths * direction / abs(direction)))
    unstable = np.flatnonzero(growth > 1.0 + 1e-9)
    return float(lengths[unstable[0]]) if len(unstable) else float(lengths[-1])
