"""Flat boxes by transforms along rows and elimination across them, over several bands of rows."""

from types import SimpleNamespace

import numpy as np
import pytest

from lines_kernels import solved_by_lines
from sceneql.flows.transforms import plans


def matrix(count, periodic, zero):
    """2 x - left - right of a row of cells, (count, count)."""
    found = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    if periodic:
        found[0, -1] -= 1.0
        found[-1, 0] -= 1.0
    else:
        found[0, 0] += 1.0 if zero[0] else -1.0
        found[-1, -1] += 1.0 if zero[1] else -1.0
    return found


@pytest.mark.parametrize("few", [False, True], ids=["all rows", "few rows"])
@pytest.mark.parametrize("around", [False, True], ids=["walls", "periodic"])
@pytest.mark.parametrize("zero", [(False, False), (False, True), (True, True)], ids=["closed", "open above", "open"])
def test_bands_come_to_what_dense_matrices_do(few, around, zero):
    """64 by 150 cells are three bands of rows."""
    nx, ny, ties = 64, 150, (1.0, 2.5)
    numbers = []
    assembly = SimpleNamespace(floats=lambda more: numbers.extend(more) or len(numbers) - len(more))
    periodic = (True, around, False)
    ends = ((False, False), zero, (False, False))
    plan, store, room = plans((nx, ny, 1), periodic, ends, ties, assembly)
    given = np.random.default_rng(3).standard_normal((ny, nx))
    first, last = (40, 137) if few else (0, ny)
    given[:first] = given[last:] = 0.0
    given[first:last] -= given[first:last].mean()
    found = given.ravel().copy()
    tables, plan = np.array(numbers), np.array(plan, dtype=np.int64)
    solved_by_lines(found, nx, ny, tables, np.zeros(room), plan, store.copy(), first, last, few, few)
    x_values, x_modes = np.linalg.eigh(matrix(nx, True, None))
    y_values, y_modes = np.linalg.eigh(matrix(ny, around, zero))
    values = ties[1] * y_values[:, None] + ties[0] * x_values
    values[values < 1e-9] = np.inf
    known = (y_modes @ ((y_modes.T @ given @ x_modes) / values) @ x_modes.T)[first:last]
    found = found.reshape(ny, nx)[first:last]
    if around or zero == (False, False):  # known up to a constant
        found, known = found - found.mean(), known - known.mean()
    assert found == pytest.approx(known, abs=1e-10 * np.abs(known).max())
