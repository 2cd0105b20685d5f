"""Separators of large domains of a sparsity pattern: by planes of several directions, of least numbers of vertices.

The couplings that a plane cuts form a bipartite graph, and any set of vertices at one end at least of each of them
separates the halves. The least such set follows from a largest matching (König 1931): beside lattices of ten-node
elements it takes less than half the multiplications that all vertices on one side of the plane would.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from sceneql.island.rising import rising

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

LARGE = 50
"""Number of vertices of a domain above which its separator is sought so."""
DIRECTIONS = [d for d in product((1, 0, -1), repeat=3) if d > (0, 0, 0)]
"""Normals of the planes: the edges, and the diagonals of faces and body, of a cube."""
UNEVEN = 2.0
"""By how much a separator may be larger, relative to the part of the vertices by which its halves differ less."""


def divide(block: NDArray[int64], parent: list[int], rows: Any, columns: Any, points: Floats) -> None:
    """Divide the domain of all vertices until none is large: ``block`` (n,) and ``parent`` as in `dissected`.

    ``rows``, ``columns``: the couplings' vertices; ``points`` (n, 3). A divided block's number stays with its
    separator; its halves get new ones.
    """
    import numpy as np

    open_blocks = [(0, np.arange(len(block)), rows, columns)]
    while open_blocks:
        number, own, one, other = open_blocks.pop()
        if len(own) <= LARGE:
            continue
        right, separator = _parted(points[own], one, other)
        inner = np.ones(len(own), dtype=bool)
        inner[separator] = False
        for kept in (inner & ~right, inner & right):
            ties, place = kept[one] & kept[other], np.cumsum(kept) - 1
            open_blocks.append((len(parent), own[kept], place[one[ties]], place[other[ties]]))
            block[own[kept]] = len(parent)
            parent.append(number)


def _parted(points: Floats, rows: Any, columns: Any) -> tuple[NDArray[bool_], NDArray[int64]]:
    """Whether each vertex is in the right half, and the vertices of the separator, by the best of all directions."""
    import numpy as np

    x, y, z = points.T
    least, best = np.inf, None
    for a, b, c in DIRECTIONS:
        right = np.zeros(len(points), dtype=bool)
        right[np.lexsort((z, y, x, a * x + b * y + c * z))[len(points) // 2 :]] = True
        crossing = ~right[rows] & right[columns]
        separator = covered(rows[crossing], columns[crossing])
        off = abs(2 * int(right.sum()) - len(points) - 2 * int(right[separator].sum()) + len(separator))
        cost = len(separator) * (1.0 + UNEVEN * off / len(points))
        if cost < least:
            least, best = cost, (right, separator)
    assert best is not None
    return best


def covered(left: NDArray[int64], right: NDArray[int64]) -> NDArray[int64]:
    """The least set of vertices with one of each edge (left[k], right[k]) of a bipartite graph (König 1931)."""
    import numpy as np
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    if not len(left):
        return left
    lefts, rights = rising(left), rising(right)
    of = np.searchsorted(lefts, left), np.searchsorted(rights, right)
    graph = csr_array((np.ones(len(left), dtype=np.int8), of), shape=(len(lefts), len(rights)))
    match = maximum_bipartite_matching(graph, perm_type="column").tolist()
    back = {column: row for row, column in enumerate(match) if column >= 0}
    starts, columns = graph.indptr.tolist(), graph.indices.tolist()
    # What alternating paths from unmatched vertices on the left reach.
    reached, seen = [row for row, column in enumerate(match) if column < 0], np.zeros(len(rights), dtype=bool)
    on_left = np.zeros(len(lefts), dtype=bool)
    on_left[reached] = True
    while reached:
        row = reached.pop()
        for column in columns[starts[row] : starts[row + 1]]:
            if not seen[column]:
                seen[column] = True
                if not on_left[back[column]]:
                    on_left[back[column]] = True
                    reached.append(back[column])
    return np.concatenate([lefts[~on_left], rights[seen]])
