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
    """Of a face, by axis [m^2]."""
    spacing: tuple[float, ...]
    """Sides of a cell [m]."""
    low: tuple[float, ...]
    """Low corner [m]."""
    ints: tuple[int, ...]
    """Integers of the projection (flows/projection_kernels.py)."""
    fractions: Any
    """(cells,) the part of each that solids leave open; None where there are none."""
    density: float
    """[kg/m^3]"""
    viscosity: float
    """[Pa s]; 0 where it varies."""
    pressure: str
    """How it is solved for, for `explain`."""
    varying: tuple[int, ...] = ()
    """Integers of the kernels of several fluids (flows/varying/fluid_layout.py); empty of one density and viscosity."""


@dataclass(frozen=True, slots=True, eq=False)
class Membrane:
    """Points, a closed skin without inertia or masses, that move as a flow does and hand it their forces."""

    count: int
    position_at: int
    """y[position_at + 3k : +3] [m]."""
    force_at: int
    """floats[force_at + 3k : +3] [N]: 0 after stage `velocity`, then what terms of `internal` and `force` add."""
    faces: NDArray[int64]
    """(m, 2) the vertices of its sides, or (m, 3) of its triangles."""
    areas: NDArray[float64]
    """(count,) of each vertex's share of it at the start [m^2]."""
    stiffness: float
    """The pressure by which contacts push it off [Pa]: by none larger do they shorten steps that its waves allow."""
    cell: float
    """Side of a cell of the flow [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Fields:
    """The fields of an island: any number at centers of cells, and at most one flow."""

    grids: tuple[Grid, ...] = ()
    flow: Flow | None = None
    alone: bool = False
    """Whether the island is these fields and nothing else, which nothing changes between steps."""
    on_elements: int = 0
    """Unknowns of fields on elements, where the island is these and nothing else."""

    @property
    def single(self) -> Grid | None:
        """The field, where the island is one at centers of cells and nothing else."""
        return self.grids[0] if self.alone and self.flow is None and len(self.grids) == 1 else None
