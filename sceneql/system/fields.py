"""Fields on regular grids as part of an island's state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The cells of a regular grid: cell (i, j, k) is number i + nx (j + ny k); offsets are into the island's floats."""

    shape: tuple[int, int, int]
    periodic: tuple[bool, bool, bool]
    outside: Any
    """(cells,) bool: not part of the domain."""
    insides_at: int
    """Volumes, 0 outside."""
    box_at: int
    """Low corner and sides of a cell, six numbers [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """An island that is one field on a regular grid, V dc/dt = sum over faces of g (neighbor - c) - sink c + fed.

    The value of cell n is y[at + n]; all other offsets are into the island's floats, one number a cell. A face's
    conductance g stands with the cell on its high side, at the first cell of a row that between its last and its first
    (0 where the field is not periodic). Cells outside the domain have V = 1 and nothing else.
    """

    cells: Cells
    at: int
    volumes_at: int
    sink_at: int
    faces_at: tuple[int, int, int]
    """Along x, y, z; that along z is not read where nz is 1."""
    varying: bool
    """Whether g and sink depend on time or on the field: the rate leaves them in the floats."""
    fed_at: int
    """What is fed, where it does not vary; else -1."""
    carried: bool
    """Whether a drift acts on it."""
    keeps: tuple[float, float] = (-math.inf, math.inf)
    """Values that it stays between by the maximum principle."""
