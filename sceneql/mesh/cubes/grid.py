"""The grid of cells on which a solid is sampled. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from math import frexp, ldexp
from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

BLOCK = 8
"""Cells along a block."""
BITS = 40
"""Bits of a cell's side, by which products with numbers of cells are exact."""
MOST_BLOCKS = 2**23
"""Most blocks of a grid, empty ones included."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Cells of one size around a box, in blocks of BLOCK cells; at least a quarter of a cell lies outside the box."""

    low: Floats
    """(3,) [m] first node."""
    cell: float
    """[m]"""
    blocks: Ints
    """(3,) along each axis."""

    @property
    def numbers(self) -> Floats:
        """First node and cell size [m], (4,), as kernels take them."""
        import numpy as np

        return np.array([*self.low, self.cell])


def grid_around(low: Corner, high: Corner, cell: float) -> Grid:
    """The grid of cells of a size [m] around a box. Raises ValueError for too many blocks or an infinite box."""
    import numpy as np

    corners = np.array([low, high], dtype=np.float64)
    if not (np.isfinite(corners).all() and (corners[1] > corners[0]).all() and 0.0 < cell < np.inf):
        raise ValueError("a grid needs a finite box and a cell above 0")
    # So that nodes of cells cut finer lie on planes of symmetry through zero, if near them, and not beside by rounding.
    cell = round(ldexp(cell, BITS - frexp(cell)[1])) * ldexp(1.0, frexp(cell)[1] - BITS)
    cells = np.ceil((corners[1] - corners[0]) / cell * (1.0 - 1e-12)) + 1.0
    blocks = np.ceil(cells / BLOCK)
    with np.errstate(over="ignore"):
        too_many = not np.prod(blocks) <= MOST_BLOCKS
    if too_many:
        size = max(b - a for a, b in zip(low, high, strict=True))
        raise ValueError(f"cells of {cell:g} m are too many for a box of {size:g} m")
    # A quarter of a cell off the middle: planes of symmetry then hold neither nodes nor middles of cells, where samples
    # are exactly zero and errors do not average out.
    first = 0.5 * (corners[0] + corners[1]) - 0.5 * cells * cell - 0.25 * cell
    return Grid(first, cell, blocks.astype(np.int32))
