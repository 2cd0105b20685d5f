"""A bounding volume hierarchy of triangles. Imports numpy and numba: to be imported by the method that runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sceneql.mesh.box_tree_kernels import grow

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats


class BoxTree(NamedTuple):
    """A hierarchy of axis-aligned boxes, its nodes in depth-first order, its triangles ordered by leaf."""

    order: NDArray[int64]
    """(m,) numbers of the triangles, those of a leaf side by side."""
    boxes: Floats
    """(b, 6) low and high corner of each node."""
    links: NDArray[int64]
    """(b, 3) by node: next node outside its subtree, first place in ``order``, number of triangles (0: no leaf)."""


def box_tree(corners: Floats, leaf: int) -> BoxTree:
    """The tree of triangles (m, 3, 3), at most ``leaf`` in a leaf. Raises ValueError without triangles."""
    count = len(corners)
    if not count:
        raise ValueError("its mesh has no triangle of any area")
    order = np.arange(count)
    nodes, links = np.empty((2 * count, 6)), np.empty((2 * count, 3), dtype=np.int64)
    bounds = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
    made = grow(bounds, order, nodes, links, np.empty((130, 3), dtype=np.int64), leaf)
    return BoxTree(order, nodes[:made].copy(), links[:made].copy())
