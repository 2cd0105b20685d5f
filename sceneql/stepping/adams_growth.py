"""The stability of Adams' formulas, predicted, evaluated, corrected and evaluated, on steps of one length."""

from __future__ import annotations

from functools import cache
from math import comb
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats

    Complexes = NDArray[np.complex128]


def growth(z: Complexes, most: int) -> float:
    """The least growth factor that one of the formulas of 1 to ``most`` rates has on y' = (z/h) y, z (n,) complex."""
    return min(growth_of(np.unique(z), k) for k in range(1, most + 1)) if len(z) else 0.0


@cache
def weights(most: int) -> tuple[float, ...]:
    """gamma_0 to gamma_most: integrals of the binomials (Hairer, Norsett & Wanner 1993, III.1, eq. 1.7)."""
    found: list[float] = []
    for k in range(most + 1):
        found.append(1.0 - sum(found[j] / (k + 1.0 - j) for j in range(k)))
    return tuple(found)


@cache
def _sums(k: int) -> tuple[Floats, Floats]:
    """(k,), (k,) over the latest k rates: the predictor, and the rate that it expects at the end."""
    gamma = weights(k)
    predicted, expected = np.zeros(k), np.zeros(k)
    for j in range(k):
        for i in range(j + 1):
            term = (-1.0) ** i * comb(j, i)
            predicted[i] += gamma[j] * term
            expected[i] += term
    return predicted, expected


def growth_of(z: Complexes, k: int) -> float:
    """That of the formula of k rates: the largest over z of the spectral radius of its map of the latest k states."""
    predicted, expected = _sums(k)
    z = z[:, None]
    prediction = z * predicted
    prediction[:, 0] += 1.0
    matrix = np.zeros((len(z), k, k), dtype=complex)
    matrix[:, 0] = prediction + weights(k)[k] * z * (prediction - expected)
    matrix[:, np.arange(1, k), np.arange(k - 1)] = 1.0
    return float(np.abs(np.linalg.eigvals(matrix)).max())
