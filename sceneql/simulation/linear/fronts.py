"""Symbolic analysis of sparse systems for the multifrontal method: which fronts there are and what each takes in.

Done once for a pattern; fronts_kernels.py factors any values on it. Sources: Duff & Reid (1983), ACM TOMS 9, 302-325;
Liu (1992), SIAM Review 34, 82-109.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from sceneql.simulation.linear.ordering import Groups, elimination_order, grouped

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    Rows = NDArray[int64]

WIDEST = 48
"""Unknowns eliminated in one front: a wider one is a chain of fronts, so that its panel stays in the cache."""
MERGED = 12
"""A front and its parent become one when both together eliminate no more than this."""


@dataclass(slots=True)
class _Front:
    columns: list[int]
    """Places (of groups) that are eliminated here, rising."""
    rows: Rows
    """Places that the front reaches, its own columns first, rising."""
    parent: int


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """How to factor values on a pattern: integers for the kernels (fronts_kernels says how they lie)."""

    numbers: Rows
    factors: int
    """Floats of the factors."""
    work: int
    """Floats of scratch."""
    operations: float
    """Multiplications of a symmetric factorization; an unsymmetric one takes twice as many."""


def plan(pattern: Any, groups: Groups | None = None) -> Plan:
    """Analyze a symmetric (n, n) scipy CSR pattern that has its whole diagonal (and may be grouped already)."""
    import numpy as np

    groups = groups or grouped(pattern)
    order, parents = elimination_order(groups.graph)
    sizes = np.array([len(groups.members[k]) for k in order], dtype=np.int64)
    fronts = _split(_fronts(groups.graph[order][:, order], parents, sizes), sizes)
    first = np.concatenate([[0], np.cumsum(sizes)])
    scalars = np.concatenate([groups.members[k] for k in order])
    return _laid_out(pattern, scalars, fronts, first)


def _fronts(graph: Any, parents: list[int], sizes: Rows) -> list[_Front]:
    """Fronts of groups by place, children first: columns of one structure, small ones merged into their parents."""
    import numpy as np

    starts, columns = graph.indptr.tolist(), graph.indices
    fronts: list[_Front] = []
    of_column = [-1] * len(parents)
    children: list[list[int]] = [[] for _ in parents]
    weight = sizes.tolist()
    for j, parent in enumerate(parents):
        below = columns[starts[j] : starts[j + 1]]
        parts = [below[below >= j], *(fronts[of_column[k]].rows for k in children[j])]
        rows = np.unique(np.concatenate(parts)) if len(parts) > 1 else np.sort(parts[0])
        rows = rows[np.searchsorted(rows, j) :]
        of_column[j] = len(fronts)
        last = of_column[j - 1] if j and parents[j - 1] == j else -1
        if last >= 0:
            own = fronts[last]
            width = sum(weight[k] for k in own.columns) + weight[j]
            # No new entry, or few: the column joins the front of the one before.
            if len(own.rows) - len(own.columns) == len(rows) or width <= MERGED:
                reached = np.concatenate([own.columns, rows])
                fronts[last] = _Front([*own.columns, j], reached, parent)
                of_column[j] = last
        if of_column[j] == len(fronts):
            fronts.append(_Front([j], rows.astype(np.int64), parent))
        if parent >= 0:
            children[parent].append(j)
    for front in fronts:
        front.parent = of_column[front.parent] if front.parent >= 0 else -1
    return fronts


def _split(fronts: list[_Front], sizes: Rows) -> list[_Front]:
    """Wide fronts as chains of fronts of at most WIDEST unknowns."""
    found: list[_Front] = []
    firsts: list[int] = []
    for front in fronts:
        firsts.append(len(found))
        chunks: list[list[int]] = [[]]
        width = 0
        for column in front.columns:
            if width + sizes[column] > WIDEST and chunks[-1]:
                chunks.append([])
                width = 0
            chunks[-1].append(column)
            width += int(sizes[column])
        done = 0
        for k, chunk in enumerate(chunks):
            last = k == len(chunks) - 1
            found.append(_Front(chunk, front.rows[done:], -2 - front.parent if last else len(found) + 1))
            done += len(chunk)
    for front in found:
        if front.parent < 0:
            parent = -2 - front.parent
            front.parent = firsts[parent] if parent >= 0 else -1
    return found


def _laid_out(pattern: Any, scalars: Rows, fronts: list[_Front], first: Rows) -> Plan:
    import numpy as np

    from sceneql.simulation.linear.fronts_kernels import FIELDS, HEAD

    n, count = len(scalars), len(fronts)
    place = np.empty(n, dtype=np.int64)
    place[scalars] = np.arange(n)
    rows = [np.concatenate([np.arange(first[k], first[k + 1]) for k in front.rows.tolist()]) for front in fronts]
    widths = [int(sum(first[k + 1] - first[k] for k in front.columns)) for front in fronts]
    front_of = np.repeat(np.arange(count), widths)

    coo = pattern.tocoo()
    i, j = place[coo.row], place[coo.col]
    owner = front_of[np.minimum(i, j)]
    by_owner = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[by_owner], np.arange(count + 1)).tolist()
    i, j = i[by_owner], j[by_owner]

    last_child, before = [-1] * count, [-1] * count
    table, entries, maps, factors = [], [], [], 0
    stack = most = 0
    waiting: list[list[int]] = [[] for _ in fronts]
    map_starts = list(accumulate((len(r) - w for r, w in zip(rows, widths, strict=True)), initial=0))
    row_starts = list(accumulate((len(r) for r in rows), initial=0))
    operations = 0.0
    for k, front in enumerate(fronts):
        height, width, rest = len(rows[k]), widths[k], len(rows[k]) - widths[k]
        if front.parent >= 0:
            before[k], last_child[front.parent] = last_child[front.parent], k
            waiting[front.parent].append(rest * rest)
            maps.append(np.searchsorted(rows[front.parent], rows[k][width:]))
        table += [int(first[front.columns[0]]), width, height, row_starts[k], map_starts[k], factors]
        table += [bounds[k], 0, 0]
        low, high = bounds[k], bounds[k + 1]
        target = np.searchsorted(rows[k], i[low:high]) * height + np.searchsorted(rows[k], j[low:high])
        entries.append(np.column_stack([by_owner[low:high], target]).ravel())
        factors += width * height + width * rest
        stack += (rest * rest if front.parent >= 0 else 0) - sum(waiting[k])
        most = max(most, stack + sum(waiting[k]))
        operations += width * rest * (rest + width) / 2.0 + width**3 / 6.0
    table += [n, 0, 0, row_starts[-1], map_starts[-1], factors, bounds[-1], -1, -1]
    for k in range(count):
        table[FIELDS * k + 7 : FIELDS * k + 9] = last_child[k], before[k]
    largest = max((len(r) for r in rows), default=0)
    parts: list[Any] = [table, scalars, np.concatenate(rows), np.concatenate([np.zeros(0, np.int64), *maps]),
             np.concatenate(entries), np.zeros(n, dtype=np.int64)]  # fmt: skip
    starts = list(accumulate((len(part) for part in parts), initial=HEAD))
    head = [n, count, *starts[1:6], most]
    numbers = np.concatenate([np.array(part, dtype=np.int64) for part in (head, *parts)])
    return Plan(numbers, factors, most + largest * largest + 2 * n, operations)
