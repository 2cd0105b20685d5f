"""Marching cubes' triangles for one size of cells, and keys of a grid's cells and edges. Imports numpy and numba."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.mesh.cubes.cases import cases
from sceneql.mesh.cubes.grid import BLOCK, Grid
from sceneql.mesh.cubes.grid_extraction import Found, GridExtraction
from sceneql.mesh.cubes.polygonise import connected

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

    Keys = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """Vertices and triangles of the cells of one size."""

    places: Floats
    normals: Floats
    triangles: Ints
    """(t, 3)"""
    doubled: Keys
    """(v, 3) midpoints of the grid edges on which vertices lie, in half cells."""
    cells: Keys
    """(t, 3) place of each triangle's cell."""
    bent: NDArray[np.int8]
    """(t,) how much the normals in the triangle's cell vary: 2 where by too much for a cell of this size, 1 by much."""


def level(shop: GridExtraction, found: Found, blocks: int) -> Level:
    """The triangles of the first ``blocks`` blocks."""
    import numpy as np

    triangles, bent = connected(shop, found, blocks)
    key = found.keys.astype(np.int64)
    owner = np.repeat(found.blocks.astype(np.int64), np.diff(found.begin), axis=0)
    doubled = 2 * (BLOCK * owner + _within(key // 3))
    doubled[np.arange(len(key)), key % 3] += 1
    cube = found.cubes[: len(bent)]
    inside = np.repeat(found.blocks[:blocks].astype(np.int64), np.diff(found.cube_at[: blocks + 1]), axis=0)
    cells = BLOCK * inside + _within(cube[:, 0].astype(np.int64))
    counts = np.diff(cases().start)[cube[:, 1]]
    return Level(
        found.place, found.normal, triangles, doubled, np.repeat(cells, counts, axis=0), np.repeat(bent, counts)
    )


def _within(place: Keys) -> Keys:
    """(n, 3) places of cells within a block, from their numbers (n,) in it."""
    import numpy as np

    return np.stack([place % BLOCK, place // BLOCK % BLOCK, place // BLOCK**2], axis=1)


class Numbering:
    """Keys of a grid's cells, groups and edges."""

    def __init__(self, grid: Grid) -> None:
        import numpy as np

        size = 2 * BLOCK * (grid.blocks.astype(np.int64) + 2)
        self.strides = np.array([1, size[0], size[0] * size[1]])

    def of(self, places: Keys) -> Keys:
        """(n,) keys of integer places (n, 3), of cells, of groups, or of edges' midpoints in half cells.

        Keys of different places of one of the three kinds differ.
        """
        found: Keys = (places + 1) @ self.strides
        return found
