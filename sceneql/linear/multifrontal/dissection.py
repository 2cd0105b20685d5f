"""Geometric nested dissection of a sparsity pattern: domains are halved by planes, separators are eliminated last.

Sources: George (1973), SIAM J. Numer. Anal. 10, 345-363; Miller, Teng, Thurston & Vavasis (1997), J. ACM 44, 1-29.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.island.rising import rising
from sceneql.linear.multifrontal.ordering import postorder
from sceneql.linear.multifrontal.separators import divide

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

LEAF = 12
"""Largest number of vertices of a domain that is not divided further."""


def dissected(graph: Any, points: Floats) -> tuple[list[NDArray[int64]], list[int]]:
    """Blocks of vertices in the order of elimination, children before parents, and each block's parent (-1: none).

    ``graph``: symmetric (n, n) scipy CSR pattern; ``points`` (n, 3). Vertices of two blocks are coupled only if one
    block is an ancestor of the other in the tree.
    """
    import numpy as np

    n = graph.shape[0]
    block = np.zeros(n, dtype=np.int64)
    parent = [-1]
    start = np.repeat(np.arange(n, dtype=np.int64), np.diff(graph.indptr))
    ends = graph.indices.astype(np.int64)
    divide(block, parent, start, ends, points)
    whole = block[start] == block[ends]
    start, ends = start[whole], ends[whole]
    open_blocks = np.bincount(block, minlength=len(parent)) > LEAF
    open_blocks[parent[1:]] = False
    while open_blocks.any():
        right = _halves(block, open_blocks, points)
        crossing = np.flatnonzero((right[start] == 0) & (right[ends] == 1) & (block[start] == block[ends]))
        on_left, on_right = rising(start[crossing]), rising(ends[crossing])
        some = len(parent)
        counts = [np.bincount(block[side], minlength=some) for side in (on_left, on_right)]
        lesser = counts[0] <= counts[1]
        separator = np.concatenate([on_left[lesser[block[on_left]]], on_right[~lesser[block[on_right]]]])
        inner = right >= 0
        inner[separator] = False
        # A divided block keeps its number for the separator; its halves become new blocks.
        divided = np.flatnonzero(open_blocks)
        first = np.full(some, -1, dtype=np.int64)
        first[divided] = some + 2 * np.arange(len(divided))
        parent += np.repeat(divided, 2).tolist()
        block[inner] = first[block[inner]] + right[inner]
        sizes = np.bincount(block, minlength=len(parent))
        open_blocks = sizes > LEAF
        open_blocks[:some] = False
        ties = inner[start] & inner[ends] & (block[start] == block[ends])
        start, ends = start[ties], ends[ties]
    order = np.array(postorder(parent), dtype=np.int64)
    by_block = np.argsort(block, kind="stable")
    bounds = np.searchsorted(block[by_block], np.arange(len(parent) + 1))
    found: list[NDArray[int64]] = []
    kept = [b for b in order.tolist() if bounds[b + 1] > bounds[b]]
    place = {-1: -1, **{b: k for k, b in enumerate(kept)}}
    above = []
    for b in kept:
        found.append(by_block[bounds[b] : bounds[b + 1]])
        up = parent[b]
        while up not in place:
            up = parent[up]
        above.append(place[up])
    return found, above


def _halves(block: NDArray[int64], open_blocks: Any, points: Floats) -> NDArray[int64]:
    """(n,): 0 or 1 for vertices in the halves of the open blocks, cut across their longest sides; -1 for others."""
    import numpy as np

    mine = np.flatnonzero(open_blocks[block])
    by_block = mine[np.argsort(block[mine], kind="stable")]
    groups = block[by_block]
    starts = np.flatnonzero(np.diff(groups, prepend=-1))
    lengths = np.diff(starts, append=len(groups))
    reach = np.maximum.reduceat(points[by_block], starts) - np.minimum.reduceat(points[by_block], starts)
    axis = np.repeat(reach.argmax(axis=1), lengths)
    inside = np.lexsort((points[by_block, axis], groups))
    rank = np.arange(len(groups)) - np.repeat(starts, lengths)
    right = np.full(len(block), -1, dtype=np.int64)
    right[by_block[inside]] = rank >= np.repeat(lengths // 2, lengths)
    return right
