"""Hierarchical clusters of triangles, with multipole moments for winding numbers (winding_kernels). Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.bodies.filling import winding_kernels
from sceneql.compiled.kernels import over_tiles
from sceneql.mesh.box_tree import box_tree

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

LEAF = 8
TILE = 512
"""Points, segments or clusters in one task of a thread."""


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Triangles in the order of a bounding volume hierarchy, and the moments of its nodes."""

    arrays: tuple[Floats, NDArray[int64], Floats]
    """Corners (m, 9) [m], links of the hierarchy (b, 3) (BoxTree) and moments (b, MOMENTS), as kernels take them."""
    boxes: Floats
    """(b, 6) [m] low and high corner of each node."""

    @classmethod
    def of(cls, corners: Floats) -> Clusters:
        """The clusters of triangles (m, 3, 3) [m]. Raises ValueError where there is none."""
        tree = box_tree(corners, LEAF)
        ordered = np.ascontiguousarray(corners[tree.order].reshape(-1, 9))
        moments = np.empty((len(tree.links), winding_kernels.MOMENTS))
        tiled(len(moments), lambda first, last: winding_kernels.gather(ordered, tree.links, moments, first, last))
        return cls((ordered, tree.links, moments), tree.boxes)

    @classmethod
    def none(cls) -> Clusters:
        """Clusters without triangles: the winding number is 0 everywhere."""
        return cls(
            (np.zeros((0, 9)), np.zeros((0, 3), np.int64), np.zeros((0, winding_kernels.MOMENTS))), np.zeros((0, 6))
        )


def tiled(count: int, work: Callable[[int, int], object]) -> None:
    """Call ``work(first, last)`` for all of ``count`` items, in tiles."""
    over_tiles(-(-count // TILE), lambda tile: work(tile * TILE, min(count, (tile + 1) * TILE)))
