"""The modes of an island at its start: eigenvalues and eigenvectors of the Jacobian of its rate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy import complex128, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.march.march import March

DENSE = 400
"""Largest number of entries of y for which all modes are computed; above, only the fastest."""
FASTEST, CLOSE = 24, 1e-4
"""Number of modes sought on a large island, and their residuals relative to the eigenvalue."""
MANY, FEW, ROUGH = 20_000, 6, 1e-2
"""Above MANY entries FEW modes are sought with residual ROUGH: eigenvalues of a fine grid lie so dense that separating
them takes minutes, while the largest one is accurate to the square of the residual."""
DIFFERENCE = 6e-6
"""Relative perturbation of central differences: the cube root of the rounding unit."""


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Eigenvalues [1/s], one of each conjugate pair, and their eigenvectors on the entries of y."""

    values: NDArray[complex128]
    vectors: NDArray[complex128]
    """(entries, modes)."""
    entries: NDArray[int64]

    @property
    def fastest(self) -> float:
        """Largest |eigenvalue| [1/s]."""
        return float(np.abs(self.values).max())

    def leading(self, mode: int, partner: NDArray[int64]) -> int:
        """The entry of y that moves most in a mode: a position where there are some."""
        moved = np.abs(self.vectors[:, mode])
        positions = partner[self.entries] >= 0
        if positions.any():
            moved = np.where(positions, moved, 0.0)
        return int(self.entries[int(np.argmax(moved))])


def modes_of(march: March) -> Modes | None:
    """The modes that can limit a step; None where the rate does not depend on the state."""
    n = len(march.system.y)
    if n <= DENSE:
        matrix = jacobian(march)
        kept = active(matrix)
        if not len(kept):
            return None
        values, vectors = np.linalg.eig(matrix[np.ix_(kept, kept)])
        entries = kept
    else:
        values, vectors = _fastest(march)
        entries = np.arange(n)
    values = values.astype(complex)
    largest = np.abs(values).max(initial=0.0)
    upper = (values.imag >= 0) & (np.abs(values) > 1e-7 * largest)
    if largest == 0.0:
        return None
    return Modes(values[upper], vectors[:, upper].astype(complex), entries)


def jacobian(march: March) -> Floats:
    """(n, n) Jacobian of the rate at the start, by central differences."""
    y = march.system.y
    steps = DIFFERENCE * np.maximum(np.abs(y), _scale(y))
    columns = []
    for k, step in enumerate(steps):
        moved = y.copy()
        moved[k] = y[k] + step
        above = march.rate(0.0, moved)
        moved[k] = y[k] - step
        columns.append((above - march.rate(0.0, moved)) / (2.0 * step))
    return np.column_stack(columns) if columns else np.zeros((0, 0))


def product(march: March, vector: Floats) -> Floats:
    """(n,) the Jacobian at the start times a vector, by a central difference."""
    y, direction = march.system.y, np.ravel(vector)
    scale, size = _scale(y), float(np.abs(direction).max(initial=0.0))
    if size == 0.0:
        return np.zeros_like(direction)
    move = DIFFERENCE * scale / size * direction
    difference: Floats = march.rate(0.0, y + move) - march.rate(0.0, y - move)
    difference *= size / (2.0 * DIFFERENCE * scale)
    return difference


def active(matrix: Floats) -> NDArray[int64]:
    """The entries on which other entries depend: not tallies of energy, nor positions under uniform gravity."""
    kept = np.arange(len(matrix))
    while True:
        used = np.any(matrix[np.ix_(kept, kept)] != 0.0, axis=0)
        if used.all():
            return kept
        kept = kept[used]


def _scale(y: Floats) -> float:
    largest = float(np.abs(y).max(initial=0.0))
    return 1e-2 * largest if largest > 0.0 else 1.0


def _fastest(march: March) -> tuple[Any, Any]:
    """Modes of largest |eigenvalue| by Arnoldi iteration (Lehoucq, Sorensen & Yang 1998), without a matrix."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

    from sceneql.march.spectrum import units_of

    y = march.system.y
    units = units_of(march.rate, march.system.partner, 0.0, y, DIFFERENCE * _scale(y))

    def in_units(vector: Floats) -> Floats:
        return product(march, units * np.ravel(vector)) / units

    operator = LinearOperator((len(y), len(y)), matvec=in_units, dtype=np.float64)
    start = np.random.Generator(np.random.Philox(1)).standard_normal(len(y))
    if not in_units(in_units(start)).any():  # free flight, or an island still empty: no eigenvalue but 0
        return np.zeros(0), np.zeros((len(y), 0))
    count, close = (FASTEST, CLOSE) if len(y) <= MANY else (FEW, ROUGH)
    try:
        values, vectors = eigs(operator, k=count, ncv=4 * count, which="LM", v0=start, tol=close, maxiter=60)
    except ArpackNoConvergence as found:
        values, vectors = found.eigenvalues, found.eigenvectors
        if not len(values):
            raise
    return values, units[:, None] * vectors
