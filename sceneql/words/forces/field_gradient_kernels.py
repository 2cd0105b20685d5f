# mypy: ignore-errors
"""The force along the gradient of a field."""

import numpy as np

from sceneql.compiled.kernels import kernel
from sceneql.grids import cell_weights_kernels as cells_of
from sceneql.grids.cell_weights_kernels import CORNERS, around, moved
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, WORK_AT, INVERSE_AT, FACTOR_AT, FIELD = range(7)
"""From FIELD on: the field (cell_weights_kernels)."""


@kernel(TERM, inner=True)
def field_gradient(t, y, rate, floats, ints):
    """Adds factor grad c at the place of every mass, and subtracts its power from the work."""
    cells, weights, slope = np.empty(CORNERS, dtype=np.int64), np.empty(CORNERS), np.empty(3)
    field, box = ints[FIELD], ints[FIELD + cells_of.BOX_AT]
    factor = floats[ints[FACTOR_AT]]
    for k in range(ints[COUNT]):
        if floats[ints[INVERSE_AT] + k] == 0.0:
            continue
        place, motion = ints[POSITION_AT] + 3 * k, ints[VELOCITY_AT] + 3 * k
        if not around(y[place], y[place + 1], y[place + 2], floats, ints, FIELD, cells, weights):
            continue
        for axis in range(3):
            slope[axis] = 0.0
            if ints[FIELD + cells_of.NX + axis] == 1:
                continue
            for corner in range(CORNERS):
                if weights[corner] > 0.0:
                    cell = cells[corner]
                    before, after = (
                        moved(cell, axis, -1, floats, ints, FIELD),
                        moved(cell, axis, 1, floats, ints, FIELD),
                    )
                    # One-sided where a neighbor is missing.
                    reach = (before != cell) + (after != cell)
                    if reach > 0:
                        slope[axis] += weights[corner] * (y[field + after] - y[field + before]) / reach
            slope[axis] *= factor / floats[box + 3 + axis]
            rate[motion + axis] += slope[axis]
            rate[ints[WORK_AT]] -= slope[axis] * y[motion + axis]
