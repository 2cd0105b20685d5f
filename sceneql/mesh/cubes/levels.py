"""Marching cubes' triangles for one size of cells, and keys of a grid's cells and edges. Imports numpy and numba."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from sceneql.mesh.cubes.border_kernels import double
from sceneql.mesh.cubes.cases import cases
from sceneql.mesh.cubes.grid import BLOCK, Grid
from sceneql.mesh.cubes.grid_extraction import Found, GridExtraction
from sceneql.mesh.cubes.polygonise import connected

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Keys = NDArray[np.int64]


class Level:
    """Vertices and triangles of the cells of one size, those of the first ``blocks`` blocks of what was found.

    ``bent`` and ``turns``, both (c,), as ``connected`` has them, are of the cells ``met``.
    """

    def __init__(self, shop: GridExtraction, found: Found, blocks: int) -> None:
        self.triangles, self.bent, self.turns = connected(shop, found, blocks)
        self.places, self.normals = found.place, found.normal
        self._found, self._blocks = found, blocks

    @cached_property
    def doubled(self) -> Keys:
        """(v, 3) midpoints of the grid edges on which vertices lie, in half cells."""
        import numpy as np

        found = self._found
        doubled = np.empty((len(found.keys), 3), dtype=np.int64)
        double(found.blocks, found.begin, found.keys, doubled)
        return doubled

    @cached_property
    def met(self) -> Keys:
        """(c, 3) places of the cells that the surface meets."""
        import numpy as np

        return self.places_of(np.arange(len(self.bent)))

    def places_of(self, cells: Keys) -> Keys:
        """(n, 3) places of some of the cells ``met``, by their numbers."""
        import numpy as np

        block = np.searchsorted(self._found.cube_at[1 : self._blocks + 1], cells, side="right")
        within = _within(self._found.cubes[cells, 0].astype(np.int64))
        found: Keys = BLOCK * self._found.blocks[block].astype(np.int64) + within
        return found

    @cached_property
    def cells(self) -> Keys:
        """(t, 3) place of each triangle's cell."""
        import numpy as np

        counts = np.diff(cases().start)[self._found.cubes[: len(self.bent), 1]]
        return np.repeat(self.met, counts, axis=0)


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
