"""Bounding volume hierarchies: one for all items of a scene, and one for each large mesh that is held."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from renderers.tracing.solids import hierarchy_kernels

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints


class Hierarchy(NamedTuple):
    """Items in the order of leaves, and nodes in depth-first order for an eye (hierarchy_kernels.build)."""

    order: NDArray[int64]
    """(m,): indices of the items, leaf by leaf."""
    nodes: Floats
    """(n, 6) [m]: low and high corners."""
    links: Ints
    """(n, 3): skip link, first item, number of items."""


class Tree:
    """Splits of items by their bounds, which do not depend on the eye, and the hierarchy for the last eye."""

    def __init__(self, boxes: Floats) -> None:
        """``boxes`` (m, 6) [m]: low and high corners of the items."""
        self.boxes = boxes
        self.bounds = np.concatenate([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])
        self._splits: Floats | None = None
        self._seen: tuple[bytes, Hierarchy] | None = None

    def seen_from(self, eye: Floats) -> Hierarchy:
        """Hierarchy of the items for an eye (3,) [m], identical to a newly built one."""
        if self._seen is None or self._seen[0] != eye.tobytes():
            if self._splits is not None:
                made = _built(self.boxes, eye, self._splits, True)
            elif self._seen is None:
                made = _built(self.boxes, eye)
            else:  # the eye moves: the splits are kept from now on
                splits = np.empty((2 * len(self.boxes), hierarchy_kernels.SPLIT_SIZE))
                made = _built(self.boxes, eye, splits)
                self._splits = splits[: len(made.nodes)].copy()
            self._seen = eye.tobytes(), made
        return self._seen[1]


def hierarchy(boxes: Floats, eye: Floats, trees: Sequence[Tree] = ()) -> Hierarchy:
    """Hierarchy of items with bounds ``boxes`` (m, 6) [m] and of the items of ``trees``, for an eye (3,) [m].

    A tree is one item of the upper hierarchy, and its nodes follow the leaf that contains it.
    """
    count = len(boxes)
    order, nodes, links = _built(np.concatenate([boxes, *(tree.bounds[None] for tree in trees)]), eye)
    if not trees:
        return Hierarchy(order, nodes, links)
    own = order >= count
    which = order[own] - count  # in the order of the walk
    seen = [trees[k].seen_from(eye) for k in which]
    starts = count + np.cumsum([0, *(len(tree.boxes) for tree in trees)])
    leaves = np.flatnonzero(links[:, 2])
    at = leaves[np.searchsorted(links[leaves, 1], np.flatnonzero(own), side="right") - 1]
    sizes = [len(one.nodes) for one in seen]
    before = np.zeros(len(nodes) + 1, dtype=np.int64)  # nodes of trees before each node
    np.add.at(before, at + 1, sizes)
    before = np.cumsum(before)
    ahead = np.concatenate([[0], np.cumsum(own)])  # trees among the items before each item
    first, last = links[:, 1], links[:, 1] + links[:, 2]
    links = np.stack(
        [links[:, 0] + before[links[:, 0]], first - ahead[first], links[:, 2] - ahead[last] + ahead[first]], axis=1
    )
    node_at = at + 1 + np.cumsum([0, *sizes])[:-1]
    item_at = count + np.cumsum([0, *(len(one.order) for one in seen)])[:-1]
    inside = [one.links + np.array([node, item, 0]) for one, node, item in zip(seen, node_at, item_at, strict=True)]
    within = [one.order + starts[k] for one, k in zip(seen, which, strict=True)]
    return Hierarchy(
        np.concatenate([order[~own], *within]),
        _followed(nodes, at, [one.nodes for one in seen]),
        _followed(links, at, inside),
    )


def _followed(rows: NDArray[Any], at: NDArray[int64], blocks: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Rows with blocks of rows inserted after the rows ``at``, which ascend."""
    parts, done = [], 0
    for row, block in zip(at, blocks, strict=True):
        parts += [rows[done : row + 1], block]
        done = row + 1
    return np.concatenate([*parts, rows[done:]])


def _built(boxes: Floats, eye: Floats, splits: Floats | None = None, known: bool = False) -> Hierarchy:
    """Hierarchy of items with bounds ``boxes`` (m, 6); arguments as in hierarchy_kernels.build."""
    count = len(boxes)
    order = np.arange(count)
    nodes = np.empty((2 * count, 6))
    links = np.empty((2 * count, 3), dtype=np.int32)
    stack = np.empty((2 * count + 2, 3), dtype=np.int64)
    bins = np.empty((hierarchy_kernels.BINS + 1, 7))
    right = np.zeros(hierarchy_kernels.BINS + 1)
    first_at = np.zeros(count + 1, dtype=np.int64)
    boxes = np.ascontiguousarray(boxes)
    splits = np.empty((0, hierarchy_kernels.SPLIT_SIZE)) if splits is None else splits
    n = hierarchy_kernels.build(boxes, order, eye, nodes, links, stack, bins, right, first_at, splits, known)
    return Hierarchy(order, nodes[:n], links[:n])
