"""Cells of a domain: volumes, areas of faces between cells, and boundary faces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

SIDES = ("left", "right", "bottom", "top", "back", "front")
"""Names of a box's sides: low and high along x, y and z."""
MOST_CELLS = 50_000_000
FARTHEST = 1e9
"""Largest distance of a box from the origin, in cells: cells' sides are then accurate to a millionth of a cell."""


def periodic_axes(boundary: Mapping[str, Any]) -> set[int]:
    """Numbers of the axes along which a box is periodic, by its boundary conditions."""
    return {SIDES.index(name) // 2 for name, part in boundary.items() if part.periodic and name in SIDES}


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryFaces:
    """The m faces of a domain's boundary."""

    cells: NDArray[int64]
    """(m,) the cell of each face."""
    areas: Floats
    """(m,) [m^2] areas."""
    distances: Floats
    """(m,) [m] distances from the cells' centers."""
    points: Floats
    """(m, 3) [m] points on the boundary at which formulas are evaluated."""
    outward: Floats
    """(m, 3) outward unit normals."""
    pieces: NDArray[int64]
    """(m,) the piece of the boundary that each face is on, an index into `names`."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """A regular grid of cells over a domain, x fastest; a two-dimensional one has one layer, as thick as its depth."""

    shape: tuple[int, int, int]
    low: Floats
    """(3,) [m] low corner of the grid."""
    spacing: Floats
    """(3,) [m] sides of a cell."""
    volumes: Floats
    """(cells,) [m^3] volume of each cell inside the domain; 0 for cells outside."""
    areas: tuple[Floats, Floats, Floats]
    """For x, y, z each (cells,) [m^2]: open area of each cell's low face; 0 on the boundary."""
    boundary: BoundaryFaces
    names: tuple[str, ...]
    """Names of the boundary's pieces."""
    around: tuple[Floats, Floats]
    """Low and high corner (3,) [m] of the domain's bounding box; z is meaningless for a two-dimensional domain."""

    @property
    def flat(self) -> bool:
        """Whether it has two dimensions."""
        return self.shape[2] == 1

    def centers(self, chosen: Any = slice(None)) -> Floats:
        """Centers (k, 3) [m] of the chosen cells."""
        import numpy as np

        nx, ny, _ = self.shape
        if isinstance(chosen, slice):
            return centers_of(self.shape, self.low, self.spacing)[chosen]
        index = np.stack([chosen % nx, chosen // nx % ny, chosen // (nx * ny)], axis=1)
        centers: Floats = self.low + (index + 0.5) * self.spacing
        return centers


def centers_of(shape: tuple[int, int, int], low: Sequence[float] | Floats, spacing: Sequence[float] | Floats) -> Floats:
    """Centers (cells, 3) [m] of the cells of a grid, x fastest."""
    import numpy as np

    found = np.empty((*shape[::-1], 3))
    for axis, count in enumerate(shape):
        row = low[axis] + (np.arange(count) + 0.5) * spacing[axis]
        found[..., axis] = row.reshape([-1 if k == 2 - axis else 1 for k in range(3)])
    return found.reshape(-1, 3)


MOST_COUNTED = 1e18
"""Bound of the number of cells along a side, so that it stays an integer; far too many in any case."""


def too_far(corner: Sequence[float], cell: float) -> str:
    """The message on a box too far from the origin for its cells of side ``cell`` [m]; empty where float64 suffices."""
    far = max(map(abs, corner))
    return "" if far <= FARTHEST * cell else f"{far:g} m from the origin rounding moves cells of {cell:g} m"


def counts(sides: tuple[float, ...], cell: float) -> tuple[int, ...]:
    """Numbers of cells along the sides [m], none longer than ``cell`` [m]; 1 along z for two sides."""
    found = [max(1, math.ceil(min(side / cell * (1.0 - 1e-9), MOST_COUNTED))) for side in sides]
    return (*found, 1) if len(found) == 2 else tuple(found)


def box(sides: tuple[float, ...], corner: tuple[float, ...], cell: float, depth: float) -> Cells:
    """The cells of a box with two or three ``sides`` [m] and a low ``corner`` [m]; ``depth`` [m] of one with two."""
    import numpy as np

    shape = counts(sides, cell)
    nx, ny, nz = shape
    flat = len(sides) == 2
    low = np.array([*corner[:2], -0.5 * depth if flat else corner[2]])
    spacing = np.array([*sides[:2], depth if flat else sides[2]]) / shape
    n = nx * ny * nz
    index = np.arange(n, dtype=np.int64).reshape(nz, ny, nx)
    volume = float(np.prod(spacing))
    areas = []
    faces: list[tuple[Any, int]] = []
    for axis in range(3):
        area = np.full((nz, ny, nx), volume / spacing[axis] if axis < 2 or not flat else 0.0)
        first, last = (index.take(end, axis=2 - axis).ravel() for end in (0, -1))
        area.ravel()[first] = 0.0
        areas.append(area.ravel())
        if axis < len(sides):
            faces += [(first, 2 * axis), (last, 2 * axis + 1)]
    owner = np.concatenate([cells for cells, _ in faces])
    piece = np.repeat([side for _, side in faces], [len(cells) for cells, _ in faces])
    centers = low + (np.stack([owner % nx, owner // nx % ny, owner // (nx * ny)], axis=1) + 0.5) * spacing
    outward = np.zeros((len(owner), 3))
    outward[np.arange(len(owner)), piece // 2] = np.where(piece % 2, 1.0, -1.0)
    distances = 0.5 * spacing[piece // 2]
    points = centers + 0.5 * outward * spacing
    boundary = BoundaryFaces(owner, (volume / spacing)[piece // 2], distances, points, outward, piece)
    names = SIDES[: 2 * len(sides)]
    return Cells(
        (nx, ny, nz),
        low,
        spacing,
        np.full(n, volume),
        (areas[0], areas[1], areas[2]),
        boundary,
        names,
        (low, low + np.array(shape) * spacing),
    )
