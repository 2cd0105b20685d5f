"""Modes of an island as small real systems, on which a solver's growth function is evaluated."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.kinds.stable_step import NEUTRAL
from sceneql.march.modes import product

if TYPE_CHECKING:
    from numpy import complex128, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.march.march import March
    from sceneql.march.modes import Modes

ERROR = 1e-6
"""Numbers below this fraction of a mode's eigenvalue are errors of differences."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """A mode as y' = jacobian y, its time scaled."""

    jacobian: Floats
    partner: NDArray[int64]
    own: float = 0.0
    """Allowed growth rate: twice the mode's own growth rate, which no method follows exactly."""


def alone(value: complex) -> Block:
    """A mode by its eigenvalue alone: an oscillator x' = v, v' = -|value|^2 x + 2 Re(value) v, or a scalar.

    For methods that treat positions and velocities alike; a mode that grows by itself counts as neutral.
    """
    damping = 0.0 if abs(value.real) < NEUTRAL or value.real > 0 else value.real
    if value.imag == 0.0:
        return Block(np.array([[damping]]), np.array([-1]))
    square = value.imag**2 + damping**2
    return Block(np.array([[0.0, 1.0], [-square, 2.0 * damping]]), np.array([1, -1]))


def paired(march: March, modes: Modes) -> list[Block]:
    """The modes as blocks for methods that advance positions by velocities, time scaled by the fastest.

    Along a mode with v = x' and v' = K x + C v the block is v' = k x + c v with the Rayleigh quotients k = <x, K x>/<x,
    x> and c = <v, C v>/<v, v>, weighted by masses. Their error is of second order in the mode's error where forces have
    a potential. An oscillation has k < 0; a charge that gyrates in a magnetic field has k = 0 and an imaginary c. Modes
    of entries without velocities are scalar.
    """
    weights = _weights(march)
    return [_block(march, modes, k, weights) for k in range(len(modes.values))]


def _block(march: March, modes: Modes, k: int, weights: Floats) -> Block:
    partner, fastest = march.system.partner, modes.fastest
    positions = np.flatnonzero(partner >= 0)
    velocities = partner[positions]
    whole = np.zeros(len(partner), dtype=complex)
    whole[modes.entries] = modes.vectors[:, k]
    value = complex(modes.values[k]) / fastest
    moving = np.zeros_like(whole)
    moving[velocities] = whole[velocities]
    placed = whole - moving
    others = placed.copy()
    others[positions] = 0.0
    if np.linalg.norm(whole - others) <= np.linalg.norm(others):
        return _real(np.array([[value]]), [-1])
    weights = weights[velocities]
    pull = _quotient(placed[positions], _product(march, placed)[velocities], weights) / fastest**2
    damping = _quotient(moving[velocities], _product(march, moving)[velocities], weights) / fastest
    size = max(abs(value), abs(pull) ** 0.5, abs(damping))
    pull, damping = _cleaned(pull, ERROR * size**2), _cleaned(damping, ERROR * size)
    return _real(np.array([[0.0, 1.0], [pull, damping]]), [1, -1])


def _product(march: March, vector: NDArray[complex128]) -> NDArray[complex128]:
    found: NDArray[complex128] = product(march, vector.real) + 1j * product(march, vector.imag)
    return found


def _quotient(vector: NDArray[complex128], change: NDArray[complex128], weights: Floats) -> complex:
    """The Rayleigh quotient; 0 where the vector is zero."""
    square = np.vdot(vector, weights * vector).real
    return complex(np.vdot(vector, weights * change) / square) if square > 0.0 else 0j


def _real(matrix: NDArray[complex128], partner: list[int]) -> Block:
    """A complex system as a real one; the real and imaginary parts are the unknowns where the matrix is not real."""
    of = np.array(partner)
    values = np.linalg.eigvals(matrix)
    own = max(0.0, float(values.real.max()))
    own = 2.0 * own if own > ERROR * float(np.abs(values).max()) else 0.0
    if not matrix.imag.any():
        return Block(matrix.real, of, own)
    real = np.block([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]])
    n = len(of)
    return Block(real, np.concatenate([of, np.where(of >= 0, of + n, -1)]), own)


def _cleaned(number: complex, least: float) -> complex:
    """The number with real or imaginary parts of at most ``least``, an error of differences, replaced by 0."""
    return complex(*(0.0 if abs(part) <= least else part for part in (number.real, number.imag)))


def _weights(march: March) -> Floats:
    """(n,) masses [kg] at entries of velocities, 0 for fixed ones; 1 at other entries."""
    weights = np.ones(len(march.system.y))
    for velocity_at, inverse_at, count in march.system.masses:
        inverse = np.repeat(march.floats[inverse_at : inverse_at + count], 3)
        weights[velocity_at : velocity_at + 3 * count] = 1.0 / np.where(inverse > 0.0, inverse, math.inf)
    return weights


def uses_pairs(solver: Any) -> bool:
    """Whether a method treats positions and velocities differently."""
    oscillator = np.array([[0.0, 1.0], [-1.0, 0.0]])
    with_pairs, without = (solver.growth(oscillator, np.array([k, -1]), 0.5) for k in (1, -1))
    return bool(abs(with_pairs - without) > 1e-9)
