"""A grid of cells around a mesh with the winding number of each cell that no triangle crosses. Imports numpy.

A mesh with lids on its holes is a closed surface, whose winding number is an integer and constant on each connected
region of cells that it does not cross: it is computed at one point of each region. The mesh's own winding number at a
point is this integer minus that of the lids, which are few.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling import winding_kernels
from sceneql.bodies.filling.clusters import Clusters
from sceneql.mesh.holes import caps, open_sides, welded

if TYPE_CHECKING:
    from numpy import int32
    from numpy.typing import NDArray

    from sceneql.frame import Floats

ALONG = 80
"""Cells along the longest side of a mesh's bounding box; a ball's surface then crosses six percent of all cells."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Cubic cells that fill the bounding box of a mesh."""

    lids: Clusters
    """Triangles that close the mesh's holes."""
    low: Floats
    """(1, 3) [m] lowest corner of the grid."""
    side: float
    """[m] side of a cell."""
    turns: NDArray[int32]
    """(nx, ny, nz) winding number in each cell of mesh and lids together; MIXED where a triangle crosses the cell."""

    @property
    def arrays(self) -> tuple[Any, ...]:
        """Arguments of the kernel `hold_in_cells`."""
        return *self.lids.arrays, self.low, self.side, self.turns

    @classmethod
    def around(cls, mesh: Clusters) -> Cells:
        """The cells of a mesh, which may have holes."""
        from scipy.ndimage import label

        corners = mesh.arrays[0]
        lids = _lids(corners)
        low, high = mesh.boxes[0, :3], mesh.boxes[0, 3:]
        side = float((high - low).max()) / ALONG
        low = (low - 0.5 * side)[None]
        turns = np.zeros(np.ceil((high - low[0]) / side + 0.5).astype(int), np.int32)
        winding_kernels.mark(corners, low, side, turns)
        winding_kernels.mark(lids.arrays[0], low, side, turns)
        regions, count = label(turns != winding_kernels.MIXED)
        _, first = np.unique(regions, return_index=True)
        found = np.full(count + 1, winding_kernels.MIXED, np.int32)
        for cell in first[regions.flat[first] > 0]:
            middle = low[0] + side * (np.array(np.unravel_index(cell, turns.shape)) + 0.5)
            found[regions.flat[cell]] = winding_kernels.turns(*mesh.arrays, *lids.arrays, *middle)
        return cls(lids, low, side, np.ascontiguousarray(found[regions]))


def _lids(corners: Floats) -> Clusters:
    """Triangles that close the holes of triangles (m, 9)."""
    places, triangles = welded(corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3))
    sides = open_sides(triangles) if len(triangles) else np.zeros((0, 2), np.int64)
    if not len(sides):
        return Clusters.none()
    places, lids = caps(places, sides)
    return Clusters.of(places[lids]) if len(lids) else Clusters.none()
