"""Elimination orders of sparse systems: minimum degree on groups of equal unknowns, and elimination trees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Groups:
    """Groups of unknowns with identical couplings, which share one place in the order and one structure."""

    members: list[NDArray[int64]]
    graph: Any
    """(groups, groups): scipy CSR pattern, with its diagonal."""


def grouped(pattern: Any) -> Groups:
    """Groups of a symmetric (n, n) scipy CSR pattern with its diagonal, indices sorted."""
    import numpy as np
    from scipy.sparse import csr_array

    found: dict[bytes, list[int]] = {}
    starts, columns = pattern.indptr.tolist(), pattern.indices
    for row in range(pattern.shape[0]):
        found.setdefault(columns[starts[row] : starts[row + 1]].tobytes(), []).append(row)
    members = [np.array(rows, dtype=np.int64) for rows in found.values()]
    group_of = np.empty(pattern.shape[0], dtype=np.int64)
    for k, rows in enumerate(members):
        group_of[rows] = k
    firsts = np.array([rows[0] for rows in members])
    some = pattern[firsts].tocoo()
    size = (len(members), len(members))
    graph = csr_array((np.ones(some.nnz), (some.row, group_of[some.col])), shape=size)
    graph.sum_duplicates()
    graph.data[:] = 1.0
    return Groups(members, graph)


def minimum_degree(graph: Any) -> NDArray[int64]:
    """Elimination order (n,) of a symmetric pattern by multiple minimum degree (Liu 1985), from SuperLU."""
    import numpy as np
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import spilu

    # The diagonal dominates, so SuperLU does not pivot. Only the order is used, which comes before its factors: those
    # of the incomplete kind, with all fill dropped, take a tenth of the time, of large ones a hundredth.
    degrees = np.diff(graph.indptr)
    matrix = csc_array(diags_array(2.0 * degrees.astype(np.float64)) - graph)
    factors = spilu(
        matrix, 1.0, 2.0, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return np.argsort(factors.perm_c).astype(np.int64)


def elimination_tree(graph: Any) -> list[int]:
    """Parent of each vertex in the elimination tree, -1 for a root (Liu 1990, algorithm 4.2)."""
    n = graph.shape[0]
    starts, columns = graph.indptr.tolist(), graph.indices.tolist()
    parent, ancestor = [-1] * n, [-1] * n
    for i in range(n):
        for p in range(starts[i], starts[i + 1]):
            k = columns[p]
            while k < i:
                above = ancestor[k]
                ancestor[k] = i
                if above == i:
                    break
                if above == -1:
                    parent[k] = i
                    break
                k = above
    return parent


def postorder(parent: list[int]) -> list[int]:
    """Vertices of a forest, children before parents, every subtree contiguous."""
    n = len(parent)
    first, following, roots = [-1] * n, [-1] * n, []
    for k in range(n - 1, -1, -1):
        if parent[k] < 0:
            roots.append(k)
        else:
            following[k] = first[parent[k]]
            first[parent[k]] = k
    order: list[int] = []
    # The stack has unfinished vertices; a child is removed from ``first`` when it is entered.
    for root in reversed(roots):
        stack = [root]
        while stack:
            child = first[stack[-1]]
            if child < 0:
                order.append(stack.pop())
            else:
                first[stack[-1]] = following[child]
                stack.append(child)
    return order


def elimination_order(graph: Any, late: NDArray[bool_] | None = None) -> tuple[NDArray[int64], list[int]]:
    """Vertices in the order of elimination, postordered, and each one's parent as a place in that order.

    ``late`` (n,): mask of vertices that must follow all their neighbors outside the mask.
    """
    import numpy as np

    order = minimum_degree(graph)
    if late is not None:
        order = _put_off(graph, order, late)
    parent = elimination_tree(graph[order][:, order])
    after = np.array(postorder(parent), dtype=np.int64)
    place = np.empty(len(after) + 1, dtype=np.int64)
    place[after] = np.arange(len(after))
    place[-1] = -1
    return order[after], place[np.array(parent, dtype=np.int64)[after]].tolist()


def _put_off(graph: Any, order: NDArray[int64], late: NDArray[bool_]) -> NDArray[int64]:
    """Order in which late vertices follow the last of their neighbors that are not late."""
    import numpy as np

    place = np.empty(len(order))
    place[order] = np.arange(len(order))
    after = place.copy()
    for vertex in np.flatnonzero(late).tolist():
        beside = graph.indices[graph.indptr[vertex] : graph.indptr[vertex + 1]]
        after[vertex] = max(place[vertex], place[beside[~late[beside]]].max(initial=-1.0) + 0.5)
    return np.argsort(after, kind="stable").astype(np.int64)
