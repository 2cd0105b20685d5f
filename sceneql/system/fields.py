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
    """A finite volume field on a regular grid, V dc/dt = sum over faces of g (neighbor - c) - sink c + fed.

    The value of cell n is y[at + n]; all other offsets are into the island's floats, one number per cell. A face's
    conductance g [m^3/s] is stored with the cell on its high side; the first cell of a row has the face between the
    row's last and first cells (0 where the field is not periodic). Cells outside the domain have V = 1 and no faces.
    """

    cells: Cells
    at: int
    volumes_at: int
    sink_at: int
    faces_at: tuple[int, int, int]
    """Conductances along x, y, z; those along z are not read where nz is 1."""
    varying: bool
    """Whether g and sink depend on time or on the field: each evaluation of the rate then writes them."""
    fed_at: int
    """Sources fed into the cells, where these are constant; else -1."""
    carried: bool
    """Whether a drift (advection) acts on it."""
    keeps: tuple[float, float] = (-math.inf, math.inf)
    """Bounds of its values by the maximum principle."""
