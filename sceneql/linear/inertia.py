"""Inertia that is a sparse matrix, as the linear systems of implicit stages have it (stage_kernels.py)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.linear.elimination import Left


@dataclass(frozen=True, slots=True, eq=False)
class Inertia:
    """The lists of a plan for it; all are empty where no inertia is a matrix."""

    entries: NDArray[int64]
    """(k, 3): place among the values of the reduced matrix, row and column (unknowns)."""
    held: NDArray[int64]
    """Places of values that are left out, in rows and columns of held entries."""
    numbers: Floats
    """(unknowns,) 1 for a row of the matrix, 0 where it is held, -1 of others; then the value of each entry [kg]."""

    @staticmethod
    def of(system: System, left: Left, pattern: Any) -> Inertia:
        """Find them; ``pattern``: the units' CSR, indices sorted."""
        import numpy as np

        none = np.zeros(0, dtype=np.int64)
        if not system.inertia:
            return Inertia(none.reshape(0, 3), none, np.zeros(0))
        m, unit, units = len(left.core), left.unit, pattern.shape[0]
        free = np.full(m, -1.0)
        rows, columns, values = _entries(system, left)
        for velocity_at, matrix in system.inertia:
            mine = (left.core >= velocity_at) & (left.core < velocity_at + matrix.shape[0])
            free[mine] = 1.0 * (matrix.diagonal()[left.core[mine] - velocity_at] > 0.0)
        fixed = np.flatnonzero(free == 0.0)
        rows, columns = np.concatenate([rows, fixed]), np.concatenate([columns, fixed])
        values = np.concatenate([values, np.ones(len(fixed))])
        row_of = np.repeat(np.arange(units, dtype=np.int64), np.diff(pattern.indptr))
        keys = row_of * units + pattern.indices
        block = np.searchsorted(keys, rows // unit * units + columns // unit)
        places = (block * unit + rows % unit) * unit + columns % unit
        i = (unit * row_of[:, None, None] + np.arange(unit)[:, None]).repeat(unit, axis=2).ravel()
        j = (unit * pattern.indices.astype(np.int64)[:, None, None] + np.arange(unit)).repeat(unit, axis=1).ravel()
        held = np.flatnonzero((free[i] == 0.0) | (free[j] == 0.0))
        return Inertia(np.column_stack([places, rows, columns]), held, np.concatenate([free, values]))


def inertia_places(system: System, left: Left) -> NDArray[int64]:
    """(k, 2) rows and columns (units) where the reduced matrix has inertia."""
    import numpy as np

    rows, columns, _ = _entries(system, left)
    return np.column_stack([rows, columns]) // left.unit


def _entries(system: System, left: Left) -> tuple[NDArray[int64], NDArray[int64], Floats]:
    """Rows, columns (unknowns) and values of all matrices between unknowns."""
    import numpy as np

    number = np.full(len(system.y), -1, dtype=np.int64)
    number[left.core] = np.arange(len(left.core))
    rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for velocity_at, matrix in system.inertia:
        found = matrix.tocoo()
        places = number[velocity_at + found.row], number[velocity_at + found.col]
        kept = (places[0] >= 0) & (places[1] >= 0) & (found.data != 0.0)
        rows.append(places[0][kept])
        columns.append(places[1][kept])
        values.append(found.data[kept])
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
