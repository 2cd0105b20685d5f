"""Fields on regular grids as part of an island's state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """An island that is one field on a regular grid, V dc/dt = sum over faces of g (neighbor - c) - sink c + fed.

    Cell (i, j, k) is y[at + i + nx (j + ny k)]; all offsets are into the island's floats, one number a cell. A face's
    conductance g stands with the cell on its high side, at the first cell of a row that between its last and its first
    (0 where the field is not periodic). Cells outside the domain have V = 1 and nothing else.
    """

    shape: tuple[int, int, int]
    at: int
    volumes_at: int
    sink_at: int
    faces_at: tuple[int, int, int]
    """Along x, y, z; that along z is not read where nz is 1."""
    periodic: tuple[bool, bool, bool]
    varying: bool
    """Whether g and sink depend on time or on the field: the rate leaves them in the floats."""
    fed_at: int
    """What is fed, where it does not vary; else -1."""
    outside: Any
    """(cells,) bool: not part of the domain."""
    insides_at: int
    """Volumes, 0 outside."""
    box_at: int
    """Low corner and sides of a cell, six numbers [m]."""
    carried: bool
    """Whether a drift acts on it."""
    keeps: tuple[float, float] = (-math.inf, math.inf)
    """Values that it stays between by the maximum principle."""
