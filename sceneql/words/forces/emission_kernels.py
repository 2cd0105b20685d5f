# mypy: ignore-errors
"""What masses give into a field."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.grids.cell_weights_kernels import CORNERS, around
from sceneql.system.signatures_kernels import TERM

FIELD = 4


@kernel(TERM, inner=True)
def emission(t, y, rate, floats, ints):
    """Adds what every mass gives to the cells around it, by their weights in the interpolant, and to the inflow.

    ints: position_at, count, inverse_at, rate, then the field (cell_weights_kernels).
    """
    cells, weights = np.empty(CORNERS, dtype=np.int64), np.empty(CORNERS)
    field, volumes = ints[FIELD], ints[FIELD + 4]
    n = ints[FIELD + 1] * ints[FIELD + 2] * ints[FIELD + 3]
    given = floats[ints[3]]
    for k in range(ints[1]):
        if floats[ints[2] + k] == 0.0:
            continue
        place = ints[0] + 3 * k
        if not around(y[place], y[place + 1], y[place + 2], floats, ints, FIELD, cells, weights):
            continue
        for corner in range(CORNERS):
            if weights[corner] > 0.0:
                rate[field + cells[corner]] += given * weights[corner] / floats[volumes + cells[corner]]
        rate[field + n] += given
