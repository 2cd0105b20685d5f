"""Elimination orders of sparse systems: minimum degree on groups of equal unknowns, the tree of eliminations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Groups:
    """Unknowns coupled to the same others, so that one order and one structure serve for all of a group."""

    members: list[NDArray[int64]]
    graph: Any
    """(groups, groups) scipy CSR pattern, with its diagonal."""


def grouped(pattern: Any) -> Groups:
    """The groups of a symmetric (n, n) scipy CSR pattern that has its diagonal; indices sorted."""
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
    """(n,) vertices of a symmetric pattern by multiple minimum degree (Liu 1985), as SuperLU has it."""
    import numpy as np
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import splu

    # Dominant diagonal: the factors, of which only the order is used, need no pivoting.
    degrees = np.diff(graph.indptr)
    matrix = csc_array(diags_array(2.0 * degrees.astype(np.float64)) - graph)
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return np.argsort(factors.perm_c).astype(np.int64)


def elimination_tree(graph: Any) -> list[int]:
    """Parent of each vertex when they are eliminated in order, -1 for a root (Liu 1990, algorithm 4.2)."""
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
    """The vertices of a forest, children before parents, every subtree contiguous."""
    n = len(parent)
    first, following, roots = [-1] * n, [-1] * n, []
    for k in range(n - 1, -1, -1):
        if parent[k] < 0:
            roots.append(k)
        else:
            following[k] = first[parent[k]]
            first[parent[k]] = k
    order: list[int] = []
    # A stack of unfinished vertices; each child is removed from ``first`` when it is entered.
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
    """Vertices in the order of elimination, postordered, and the parents by place in that order.

    ``late`` (n,): vertices that come after all their neighbors that are not late.
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
    """An order in which late vertices follow the last of their neighbors that are not."""
    import numpy as np

    place = np.empty(len(order))
    place[order] = np.arange(len(order))
    after = place.copy()
    for vertex in np.flatnonzero(late).tolist():
        beside = graph.indices[graph.indptr[vertex] : graph.indptr[vertex + 1]]
        after[vertex] = max(place[vertex], place[beside[~late[beside]]].max(initial=-1.0) + 0.5)
    return np.argsort(after, kind="stable").astype(np.int64)
