"""Estimate of an island's fastest modes at any moment, by little more than a dozen evaluations of the rate."""

from __future__ import annotations

import cmath
import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import complex128, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

    Complexes = NDArray[complex128]
    Partners = NDArray[int64]
    Rate = Callable[[float, Floats], Floats]
    """dy/dt (n,) at a time [s] and state."""

SMALL = 12
"""Largest number of entries of y for which the whole Jacobian is found; above, the dimension of the Krylov space."""
MOVE = 1.5e-8
"""Relative size of differences: the root of the rounding unit."""
LENGTHS = np.geomspace(0.1, 50.0, 400)
"""Values of |step times eigenvalue| at which the stability of a method is evaluated."""


def dominant(values: Complexes) -> complex:
    """The eigenvalue of largest modulus, of a conjugate pair the upper one; 0 where there is none."""
    if not len(values):
        return 0j
    found = complex(values[int(np.argmax(np.abs(values) + 1e-3 * np.abs(values.imag)))])  # of equals, an oscillation
    return complex(found.real, abs(found.imag))


@np.errstate(over="ignore", invalid="ignore")
def spectrum(rate_at: Rate, partner: Partners, t: float, y: Floats, negligible: float = 0.0) -> Complexes:
    """The outermost eigenvalues [1/s] of the rate's Jacobian at a state.

    ``partner`` (n,): for a position entry of y the index of its velocity, else -1. Empty where a norm bounds all of
    them below ``negligible`` [1/s]. Above SMALL entries by Arnoldi's iteration (Arnoldi 1951).
    """
    n = len(y)
    rate = rate_at(t, y)
    matrix = _by_differences(rate_at, rate, t, y) if n <= SMALL else _projected(rate_at, partner, rate, t, y)
    if (negligible and _radius_at_most(matrix) < negligible) or not np.isfinite(matrix).all():
        return np.zeros(0, dtype=complex)
    return np.linalg.eigvals(matrix).astype(complex)


def _by_differences(rate_at: Rate, rate: Floats, t: float, y: Floats) -> Floats:
    """The Jacobian (n, n), by forward differences."""
    matrix = np.empty((len(y), len(y)))
    moved = y.copy()
    for k, value in enumerate(y.tolist()):
        move = MOVE * max(abs(value), 1e-3)
        moved[k] = value + move
        matrix[:, k] = (rate_at(t, moved) - rate) / move
        moved[k] = value
    return matrix


def _projected(rate_at: Rate, partner: Partners, rate: Floats, t: float, y: Floats) -> Floats:
    """The Jacobian on a Krylov space of dimension SMALL or less."""
    scale = MOVE * max(1e-3, math.sqrt(float(y @ y)))
    units = scale * units_of(rate_at, partner, t, y, scale)
    basis = np.zeros((SMALL + 1, len(y)))
    matrix = np.zeros((SMALL + 1, SMALL))
    basis[0] = _anywhere(len(y))
    size, largest = 0, 0.0
    for k in range(SMALL):
        product = (rate_at(t, y + units * basis[k]) - rate) / units
        for _ in range(2):  # twice: rounding errors of one pass would grow from vector to vector
            along = basis[: k + 1] @ product
            matrix[: k + 1, k] += along
            product -= along @ basis[: k + 1]
        size = k + 1
        matrix[size, k] = left = math.sqrt(float(product @ product))
        largest = max(largest, left, float(np.abs(matrix[:size, k]).max()))
        if not left > 1e-10 * largest:
            break
        basis[size] = product / left
    return matrix[:size, :size]


@cache
def _anywhere(n: int) -> Floats:
    """A random unit vector (n,)."""
    found: Floats = np.random.Generator(np.random.Philox(1)).standard_normal(n)
    found /= np.linalg.norm(found)
    return found


def _radius_at_most(matrix: Floats) -> float:
    """A bound on the moduli of a matrix's eigenvalues: |A^4|^(1/4) in the Frobenius norm; NaN where it overflows."""
    with np.errstate(over="ignore", invalid="ignore"):
        square = matrix @ matrix
        fourth = (square @ square).ravel()
        return math.sqrt(math.sqrt(math.sqrt(float(fourth @ fourth))))


def units_of(rate_at: Rate, partner: Partners, t: float, y: Floats, scale: float) -> Floats:
    """Units (n,) in which positions and velocities of stiff springs have the same magnitude."""
    units = np.ones(len(y))
    positions = np.flatnonzero(partner >= 0)
    if len(positions):
        velocities = partner[positions]
        moved = y.copy()
        # Random moves: a common translation would not stretch the springs between masses.
        moved[positions] += scale * np.random.Generator(np.random.Philox(2)).standard_normal(len(positions))
        pull = (rate_at(t, moved) - rate_at(t, y))[velocities] / scale
        square = float(np.sqrt(np.mean(pull * pull)))
        units[velocities] = np.sqrt(square) if 0.0 < square < np.inf else 1.0
    return units


def boundary(coefficients: tuple[float, ...], direction: complex) -> float:
    """Largest r with |R(s u)| <= 1 for 0 <= s <= r in direction u.

    R: a polynomial, given by its coefficients from z^0 on.
    """
    along = math.atan2(abs(direction.imag), -direction.real) if direction.real < 0.0 else math.pi / 2
    return _boundary(coefficients, round(100 * along / (math.pi / 2)))


@cache
def least_boundary(coefficients: tuple[float, ...]) -> float:
    """The least of `boundary` over the directions of decays, of oscillations, and midway."""
    return min(_boundary(coefficients, k) for k in (0, 50, 100))


@cache
def _boundary(coefficients: tuple[float, ...], hundredths: int) -> float:
    """`boundary` in the direction at ``hundredths`` of a right angle from the negative real axis."""
    angle = math.pi * (1.0 - hundredths / 200.0)
    growth = np.abs(np.polyval(coefficients[::-1], LENGTHS * cmath.exp(1j * angle)))
    unstable = np.flatnonzero(growth > 1.0 + 1e-9)
    return float(LENGTHS[unstable[0] if len(unstable) else -1])
