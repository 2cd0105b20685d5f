"""Fields and flows on regular grids as part of an island's state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import float64, int64
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The cells of a regular grid: cell (i, j, k) has index i + nx (j + ny k).

    ``..._at`` are offsets into the island's floats.
    """

    shape: tuple[int, int, int]
    periodic: tuple[bool, bool, bool]
    outside: Any
    """(cells,) bool: whether a cell lies outside the domain."""
    insides_at: int
    """(cells,) volumes [m^3] of cells inside the domain; 0 outside."""
    box_at: int
    """Low corner of the grid and sides of a cell, six numbers [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """A finite volume field on a regular grid, V dc/dt = sum over faces of g (neighbor - c) - sink c + fed.

    The value c of cell n is y[at + n]; all other offsets are into the island's floats, one number per cell. A face's
    conductance g [m^3/s] is stored with the cell on its high side. In a periodic direction the first cell of a row
    stores the face between the row's last and first cells; 0 if not periodic. Cells outside the domain have V = 1 and
    no faces.
    """

    cells: Cells
    at: int
    volumes_at: int
    sink_at: int
    faces_at: tuple[int, int, int]
    """Conductances along x, y, z; those along z are not read where nz is 1."""
    varying: bool
    """Whether g and sink depend on time or on the field; each evaluation of the rate then rewrites them."""
    fed_at: int
    """Offset of the sources fed, where these are constant; else -1."""
    carried: bool
    """Whether a drift (advection) acts on it."""
    keeps: tuple[float, float] = (-math.inf, math.inf)
    """Bounds of its values by the maximum principle."""


@dataclass(frozen=True, slots=True, eq=False)
class Flow:
    """An incompressible flow on a staggered grid: a velocity component at the faces of its axis, pressure at centers.

    Component a has entry i + nx (j + ny k) for the face on the low side of cell (i, j, k), with a last face beyond the
    last cell where the axis is not periodic (Harlow and Welch 1965). Each component is a `Grid`, whose conductances are
    those of viscosity and whose ``cells.insides_at`` are volumes that are 0 where a velocity is given.
    """

    cells: Cells
    components: tuple[Grid, ...]
    """Two in a flat flow, three in a deep one."""
    areas: tuple[float, ...]
    """Areas of a cell's faces, by axis [m^2]."""
    spacing: tuple[float, ...]
    """Sides of a cell [m]."""
    low: tuple[float, ...]
    """Low corner [m]."""
    ints: tuple[int, ...]
    """Integers of the projection (flows/projection_kernels.py)."""
    fractions: Any
    """(cells,) fraction of each cell that solids leave open; None without solids."""
    density: float
    """[kg/m^3]"""
    viscosity: float
    """[Pa s]; 0 where it varies in space."""
    pressure: str
    """How the pressure is solved for, as text for `explain`."""
    varying: tuple[int, ...] = ()
    """Integers of the kernels of several fluids (flows/varying/fluid_layout.py); empty for one density and
    viscosity."""


@dataclass(frozen=True, slots=True, eq=False)
class Membrane:
    """Points that move with a flow and exert their forces on it: vertices of a closed massless skin, or masses."""

    count: int
    position_at: int
    """y[position_at + 3k : +3] [m]."""
    force_at: int
    """floats[force_at + 3k : +3] [N]: 0 after stage `velocity`, then what terms of `internal` and `force` add."""
    faces: NDArray[int64]
    """(m, 2) vertices of the skin's edges in a flat flow, or (m, 3) of its triangles in a deep one."""
    areas: NDArray[float64]
    """(count,) each vertex's share of the skin's area at the start [m^2]."""
    stiffness: float
    """Contact stiffness as a pressure [Pa], the largest that does not shorten the steps that the skin's own waves
    allow."""
    cell: float
    """Side of a cell of the flow [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Fields:
    """The fields of an island: any number of cell-centered grids, and at most one flow."""

    grids: tuple[Grid, ...] = ()
    flow: Flow | None = None
    alone: bool = False
    """Whether the island consists of these fields alone, and nothing changes them between steps."""
    on_elements: int = 0
    """Number of unknowns of finite element fields, where the island consists of these alone; else 0."""
    stiff: tuple[tuple[str, Any], ...] = ()
    """(kernel, integers) of terms that additive methods may march implicitly (System.stiff)."""

    @property
    def single(self) -> Grid | None:
        """The only field, where the island consists of one cell-centered grid; else None."""
        return self.grids[0] if self.alone and self.flow is None and len(self.grids) == 1 else None
