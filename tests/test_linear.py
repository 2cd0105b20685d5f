"""Linear systems: factorizations and iterations against their own residuals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sceneql.simulation.linear import dense_kernels as dense

UNIT = 2.3e-16


@settings(max_examples=50, deadline=None)
@given(n=st.integers(1, 40), seed=st.integers(0, 2**32))
def test_dense_factors_solve_to_rounding(n, seed):
    draw = np.random.default_rng(seed)
    matrix, right = draw.standard_normal((n, n)), draw.standard_normal(n)
    a, pivots, x = matrix.ravel().copy(), np.zeros(n, dtype=np.int64), right.copy()
    assert dense.factor(a, n, pivots)
    dense.solve(a, n, pivots, x)
    residual = np.abs(matrix @ x - right).max()
    assert residual <= 100 * n * UNIT * (np.abs(matrix).sum(axis=1).max() * np.abs(x).max() + 1)


@settings(max_examples=50, deadline=None)
@given(n=st.integers(1, 40), seed=st.integers(0, 2**32))
def test_complex_factors_solve_to_rounding(n, seed):
    draw = np.random.default_rng(seed)
    matrix = draw.standard_normal((n, n)) + 1j * draw.standard_normal((n, n))
    right = draw.standard_normal(n) + 1j * draw.standard_normal(n)
    a, b, pivots = matrix.real.ravel().copy(), matrix.imag.ravel().copy(), np.zeros(n, dtype=np.int64)
    x, y = right.real.copy(), right.imag.copy()
    assert dense.factor_complex(a, b, n, pivots)
    dense.solve_complex(a, b, n, pivots, x, y)
    z = x + 1j * y
    residual = np.abs(matrix @ z - right).max()
    assert residual <= 100 * n * UNIT * (np.abs(matrix).sum(axis=1).max() * np.abs(z).max() + 1)


@pytest.mark.parametrize("matrix", [np.zeros((2, 2)), np.array([[1.0, 2.0], [2.0, 4.0]]), np.full((2, 2), np.nan)])
def test_a_singular_matrix_is_refused(matrix):
    pivots = np.zeros(2, dtype=np.int64)
    assert not dense.factor(matrix.ravel().copy(), 2, pivots)
    assert not dense.factor_complex(matrix.ravel().copy(), np.zeros(4), 2, pivots)


def test_pivots_are_sought():
    a, pivots, x = np.array([0.0, 1.0, 1.0, 0.0]), np.zeros(2, dtype=np.int64), np.array([3.0, 5.0])
    assert dense.factor(a, 2, pivots)
    dense.solve(a, 2, pivots, x)
    assert x.tolist() == [5.0, 3.0]
