"""Flat boxes by transforms along x and elimination across them, beside sparse factors of the same equation."""

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

from lines_kernels import solved_by_lines
from sceneql.flows.layout import (
    COSINES,
    FREE_FREE,
    FREE_NODES,
    NODES,
    NODES_FREE,
    QUARTER_COSINES,
    QUARTER_SINES,
    SINES,
    WAVES,
)
from sceneql.flows.lines_kernels import BAND, BOTH, HEAD, prepare
from sceneql.flows.transforms import lines_room, modes, plan_of

ENDS = {
    COSINES: ("closed", "closed"),
    SINES: ("zero", "zero"),
    QUARTER_COSINES: ("closed", "zero"),
    QUARTER_SINES: ("zero", "closed"),
    WAVES: None,
    NODES: ("held", "held"),
    NODES_FREE: ("held", "free"),
    FREE_NODES: ("free", "held"),
    FREE_FREE: ("free", "free"),
}
"""What stands at the low and the high end: of values at centers, 0 at the face or the same beyond; at faces."""


def across(count, kind):
    """2 x_j - x_(j-1) - x_(j+1) (count, count); rows of values that are held are 0."""
    found = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(count, count)).tolil()
    if kind == WAVES:
        found[0, count - 1] = found[count - 1, 0] = -1.0
        return found.tocsr()
    for end, beside, what in ((0, 1, ENDS[kind][0]), (count - 1, count - 2, ENDS[kind][1])):
        if what == "held":
            found[end, :] = 0.0
        elif what == "free":
            found[end, beside] = -2.0
        else:
            found[end, end] = 1.0 if what == "closed" else 3.0
    return found.tocsr()


@pytest.mark.parametrize("kind", ENDS)
@pytest.mark.parametrize("a", [1e-3, 0.7, 300.0])
@pytest.mark.parametrize("periodic", [False, True])
def test_bands_of_rows_come_to_what_factors_do(kind, a, periodic):
    nx, tie_x, tie_y = 24, 0.8, 1.3
    rows = BOTH * (BAND // (BOTH * nx))
    ny = 2 * rows + 7  # three bands, the last of which is no full one
    kind_x, length, along_x = modes(nx, periodic, (False, False))
    tables = []

    def store_numbers(values):
        tables.extend(values)
        return len(tables) - len(values)

    plan = np.array(plan_of(kind_x, length, store_numbers), dtype=np.int64)
    room = lines_room((nx, ny, 1), kind, tie_x * along_x, tie_y)
    store = np.zeros(room)
    assert prepare(store, nx, ny, kind, 0.0, 1.0, a, tie_x * along_x, a * tie_y, float(length)) > HEAD
    given = np.random.default_rng(kind).standard_normal((ny, nx))
    if kind != WAVES:
        given[[end for end, what in zip((0, -1), ENDS[kind], strict=True) if what == "held"]] = 0.0
    found, scratch = given.copy(), np.zeros(BOTH * (9 * nx + 17) + 48)
    solved_by_lines(found.ravel(), nx, ny, np.array(tables), scratch, plan, store, 0, ny, False, False)
    whole = sparse.kron(sparse.eye_array(ny), tie_x * across(nx, kind_x)) + sparse.kron(
        tie_y * across(ny, kind), sparse.eye_array(nx)
    )
    known = spsolve((sparse.eye_array(nx * ny) + a * whole).tocsc(), given.ravel()).reshape(ny, nx)
    if kind != WAVES:
        known[given.any(axis=1) == 0.0] = 0.0
    assert found == pytest.approx(known, abs=1e-12)
