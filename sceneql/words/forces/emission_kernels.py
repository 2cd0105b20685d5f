# mypy: ignore-errors
"""The sources that masses are to a field."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.grids import cell_weights_kernels as cells_of
from sceneql.grids.cell_weights_kernels import CORNERS, around
from sceneql.system.signatures_kernels import TERM

POSITION_AT, COUNT, INVERSE_AT, GIVEN_AT, FIELD = range(5)
"""From FIELD on: the field (cell_weights_kernels)."""


@kernel(TERM, inner=True)
def emission(t, y, rate, floats, ints):
    """Adds every mass's source to the cells around it, by their interpolation weights, and to the total inflow."""
    cells, weights = np.empty(CORNERS, dtype=np.int64), np.empty(CORNERS)
    field, volumes = ints[FIELD], ints[FIELD + cells_of.VOLUMES_AT]
    n = ints[FIELD + cells_of.NX] * ints[FIELD + cells_of.NY] * ints[FIELD + cells_of.NZ]
    given = floats[ints[GIVEN_AT]]
    for k in range(ints[COUNT]):
        if floats[ints[INVERSE_AT] + k] == 0.0:
            continue
        place = ints[POSITION_AT] + 3 * k
        if not around(y[place], y[place + 1], y[place + 2], floats, ints, FIELD, cells, weights):
            continue
        for corner in range(CORNERS):
            if weights[corner] > 0.0:
                rate[field + cells[corner]] += given * weights[corner] / floats[volumes + cells[corner]]
        rate[field + n] += given
