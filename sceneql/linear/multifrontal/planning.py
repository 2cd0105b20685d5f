"""Symbolic analysis of sparse systems for the multifrontal method: fronts, and the entries assembled into each.

One analysis serves a pattern; systems_kernels.py factors any values on it. Sources: Duff & Reid (1983), ACM TOMS 9,
302-325; Liu (1992), SIAM Review 34, 82-109.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from sceneql.island.rising import rising
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.dissection import dissected
from sceneql.linear.multifrontal.ordering import Groups, elimination_order, grouped

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

    Rows = NDArray[int64]

MERGED = 12
"""Largest number of unknowns of a front and its parent together for which they are merged."""
WORTH_THREADS = 1e7
"""Multiplications of a factorization above which threads share it."""
WORTH_SINGLE = 1e8
"""Multiplications above which single precision is tried first."""
PIECE = 0.55
"""Fraction of all operations above which a subtree is divided, so that two threads get nearly equal shares."""
MOST_PIECES = 16
"""Largest number of subtrees that threads share."""


@dataclass(slots=True)
class _Front:
    columns: list[int]
    """Places of the groups eliminated in the front, ascending."""
    rows: Rows
    """Places of the groups in the front's rows, its own columns first, ascending."""
    parent: int


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Plan of a factorization on a pattern: integers for the kernels (layout: systems_kernels)."""

    numbers: Rows
    factors: int
    """Number of floats of the factors."""
    work: int
    """Number of scratch floats."""
    operations: float
    """Multiplications of a symmetric factorization; an unsymmetric one takes twice as many."""


def plan(
    pattern: Any,
    groups: Groups | None = None,
    points: Floats | None = None,
    unit: int = 1,
    exact: bool = True,
    border: int = 0,
    symmetric: bool = False,
) -> Plan:
    """Analyze a symmetric (n, n) scipy CSR pattern with a full diagonal.

    ``groups``: the pattern's groups, if known already.
    ``points`` (n, 3): positions of the unknowns, for nested dissection; None: minimum degree.
    ``unit``: number of unknowns for each of the n; value k of the pattern is a block (unit, unit), row by row.
    ``exact``: False allows errors of some percent in solutions, for an iteration that corrects them.
    ``border``: number of last unknowns whose diagonals may vanish; they are eliminated after all their neighbors.
    ``symmetric``: whether all matrices are symmetric, so that L needs no storage.
    """
    import numpy as np

    groups = groups or grouped(pattern)
    if points is None:
        late = np.array([members[0] >= len(pattern.indptr) - 1 - border for members in groups.members])
        order, parents = elimination_order(groups.graph, late if border else None)
        graph = groups.graph[order][:, order]
    else:
        blocks, parents = dissected(groups.graph, points[[members[0] for members in groups.members]])
        order = np.concatenate(blocks)
        graph = groups.graph[order][:, order]
    members = [groups.members[k] for k in order]
    sizes = unit * np.array([len(some) for some in members], dtype=np.int64)
    fronts = _fronts(graph, parents, sizes) if points is None else _fronts_of_blocks(graph, parents, blocks)
    first = np.concatenate([[0], np.cumsum(sizes)])
    return _laid_out(pattern, np.concatenate(members), fronts, first, unit, exact, symmetric)


def _fronts_of_blocks(graph: Any, parents: list[int], blocks: list[Rows]) -> list[_Front]:
    """One front for each block of a dissection; vertices are numbered in the order of the blocks."""
    import numpy as np

    starts, columns = graph.indptr, graph.indices.astype(np.int64)
    reached: list[list[Rows]] = [[] for _ in blocks]
    fronts: list[_Front] = []
    low = 0
    for k, block in enumerate(blocks):
        high = low + len(block)
        own = columns[starts[low] : starts[high]]
        beyond = rising(np.concatenate([own[own >= high], *(rest[rest >= high] for rest in reached[k])]))
        if parents[k] >= 0:
            reached[parents[k]].append(beyond)
        mine = np.arange(low, high)
        fronts.append(_Front(mine.tolist(), np.concatenate([mine, beyond]), parents[k]))
        low = high
    return fronts


def _fronts(graph: Any, parents: list[int], sizes: Rows) -> list[_Front]:
    """Fronts by places of groups, children first: columns with one structure share a front, small fronts are merged."""
    import numpy as np

    starts, columns = graph.indptr.tolist(), graph.indices
    fronts: list[_Front] = []
    of_column = [-1] * len(parents)
    children: list[list[int]] = [[] for _ in parents]
    weight = sizes.tolist()
    widths: list[int] = []
    for j, parent in enumerate(parents):
        below = columns[starts[j] : starts[j + 1]]
        parts = [below[below >= j], *(fronts[of_column[k]].rows for k in children[j])]
        rows = rising(np.concatenate(parts)) if len(parts) > 1 else np.sort(parts[0])
        rows = rows[np.searchsorted(rows, j) :]
        of_column[j] = len(fronts)
        last = of_column[j - 1] if j and parents[j - 1] == j else -1
        if last >= 0:
            own = fronts[last]
            width = widths[last] + weight[j]
            # With little or no fill the column joins the front of the previous column.
            if len(own.rows) - len(own.columns) == len(rows) or width <= MERGED:
                reached = np.concatenate([own.columns, rows])
                fronts[last] = _Front([*own.columns, j], reached, parent)
                of_column[j] = last
                widths[last] = width
        if of_column[j] == len(fronts):
            fronts.append(_Front([j], rows.astype(np.int64), parent))
            widths.append(weight[j])
        if parent >= 0:
            children[parent].append(j)
    for front in fronts:
        front.parent = of_column[front.parent] if front.parent >= 0 else -1
    return fronts


def _laid_out(
    pattern: Any, order: Rows, fronts: list[_Front], first: Rows, unit: int, exact: bool, symmetric: bool
) -> Plan:
    import numpy as np

    from sceneql.compiled.threads_kernels import threads

    n, count, groups = unit * len(order), len(fronts), len(first) - 1
    scalars = (unit * order[:, None] + np.arange(unit)).ravel()
    sizes = np.diff(first)
    group_of = np.repeat(np.arange(groups), sizes)
    lengths = np.array([len(front.rows) for front in fronts])
    rows = np.concatenate([front.rows for front in fronts])
    widths = np.array([first[front.columns[-1] + 1] - first[front.columns[0]] for front in fronts])
    # Start of each group among the unknowns of its front; the number (front, group) ascends, for searchsorted.
    numbered = np.repeat(np.arange(count), lengths) * groups + rows
    before = np.cumsum(sizes[rows]) - sizes[rows]
    row_starts = np.concatenate([[0], before[np.cumsum(lengths)[:-1]], [sizes[rows].sum()]])
    heights = np.diff(row_starts)
    expanded = np.repeat(first[rows] - before, sizes[rows]) + np.arange(row_starts[-1])

    place = np.empty(len(order), dtype=np.int64)
    place[order] = unit * np.arange(len(order))
    i = np.repeat(place, np.diff(pattern.indptr))
    j = place[pattern.indices]
    owner = np.repeat(np.arange(count), widths)[np.minimum(i, j)]

    def inside(front: Rows, unknown: Rows) -> Rows:
        """Places of unknowns in fronts."""
        group = group_of[unknown]
        found = before[np.searchsorted(numbered, front * groups + group)]
        places: Rows = found - row_starts[front] + unknown - first[group]
        return places

    target = inside(owner, i) * heights[owner] + inside(owner, j)
    # The upper triangle of each front's panel comes first: symmetric matrices need only that.
    kinds = 2 * owner + (i > j)
    by_owner = np.argsort(kinds, kind="stable")
    bounds = np.searchsorted(kinds[by_owner], np.arange(2 * count + 1)).tolist()
    entries = np.column_stack([unit * unit * by_owner, target[by_owner]]).ravel()

    last_child, earlier = [-1] * count, [-1] * count
    table: list[int] = []
    factors = 0
    rests = heights - widths
    parents = np.array([front.parent for front in fronts])
    up = np.flatnonzero((parents >= 0) & (rests > 0))
    climbing = np.concatenate(
        [np.zeros(0, np.int64), *(np.arange(row_starts[k] + widths[k], row_starts[k + 1]) for k in up)]
    )
    maps, run_counts = _runs(inside(np.repeat(parents[up], rests[up]), expanded[climbing]), rests[up])
    map_sizes = np.zeros(count, dtype=np.int64)
    map_sizes[up] = 2 * run_counts
    map_at = 0
    operations = widths * rests * heights / 2.0 + widths**3 / 6.0
    pieces = _pieces(parents.tolist(), operations.tolist())
    updates, room = _updates(parents.tolist(), (rests**2).tolist(), pieces)
    for k, (front, height, width, rest) in enumerate(
        zip(fronts, heights.tolist(), widths.tolist(), rests.tolist(), strict=True)
    ):
        table += [int(first[front.columns[0]]), width, height, int(row_starts[k]), map_at, factors, bounds[2 * k], 0, 0]
        table += [updates[k], bounds[2 * k + 1]]
        if front.parent >= 0:
            earlier[k], last_child[front.parent] = last_child[front.parent], k
            map_at += int(map_sizes[k])
        factors += width * height + (0 if symmetric else width * rest) + layout.PAD
    table += [n, 0, 0, int(row_starts[-1]), map_at, factors, bounds[-1], -1, -1, 0, 0]
    for k in range(count):
        table[layout.FIELDS * k + 7 : layout.FIELDS * k + 9] = last_child[k], earlier[k]
    largest = int(heights.max(initial=0))
    halves = [number for first_front, root in pieces for number in (first_front, root + 1, 0)]
    parts: list[Any] = [table, scalars, expanded, maps, entries, np.zeros(n, dtype=np.int64), halves]
    parts += [pattern.indptr, pattern.indices]
    starts = list(accumulate((len(part) for part in parts), initial=layout.HEAD))
    piece, *passes = _of_pieces() if pieces else [0] * 3
    head = [n, count, *starts[1:6], room, starts[6], len(pieces), *threads(), piece, unit, *passes]
    head += [*_single(float(operations.sum())), 0, 0, int(exact), 0, *starts[7:9]]
    numbers = np.concatenate([np.array(part, dtype=np.int64) for part in (head, *parts)])
    work = max(room + largest * largest, int(row_starts[-1]) + layout.PAD * count) + 2 * n
    return Plan(numbers, factors, work, float(operations.sum()))


def _of_pieces() -> list[int]:
    """Addresses of the kernels that factor a piece and solve in it."""
    from sceneql.compiled.threads_kernels import tile_address
    from sceneql.linear.multifrontal.pieces_kernels import backward_piece, forward_piece, piece

    return [tile_address(one) for one in (piece, forward_piece, backward_piece)]


def _single(operations: float) -> list[int]:
    """Numbers and addresses of the kernels in single precision; all -1 below WORTH_SINGLE operations."""
    if operations < WORTH_SINGLE:
        return [-1] * 5
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.compiled.threads_kernels import tile_address
    from sceneql.linear.multifrontal import single_precision_kernels as single
    from sceneql.linear.multifrontal.entries_kernels import FACTOR_SINGLE, SOLVE_SINGLE

    pieces = (single.single_piece, single.single_forward_piece, single.single_backward_piece)
    numbers = [number_of(single.factor_single, FACTOR_SINGLE), number_of(single.solve_single, SOLVE_SINGLE)]
    return numbers + [tile_address(piece) for piece in pieces]


def _runs(places: Rows, counts: Rows) -> tuple[Rows, Rows]:
    """Maps compressed to runs of consecutive places, and the number of runs of each map.

    ``places``: all maps, one after another; ``counts``: length of each map. A run is (end in its own map, first
    place), and never continues into the next map.
    """
    import numpy as np

    own = np.arange(len(places)) - np.repeat(np.cumsum(counts) - counts, counts)
    starts = np.flatnonzero((own == 0) | (np.diff(places, prepend=-2) != 1))
    lengths = np.diff(np.append(starts, len(places)))
    runs = np.column_stack([own[starts] + lengths, places[starts]]).ravel()
    return runs, np.diff(np.append(np.flatnonzero(own[starts] == 0), len(starts)))


def _pieces(parents: list[int], operations: list[float]) -> list[tuple[int, int]]:
    """Subtrees that threads share, as (first front, root), ascending; none if there are too few operations.

    The heaviest is divided while it has more than PIECE of all operations and there are fewer than MOST_PIECES.
    """
    weights, sizes = list(operations), [1] * len(parents)
    children: list[list[int]] = [[] for _ in parents]
    for k, parent in enumerate(parents):
        if parent >= 0:
            weights[parent] += weights[k]
            sizes[parent] += sizes[k]
            children[parent].append(k)
    total = sum(operations)
    if total < WORTH_THREADS:
        return []
    roots = {k for k, parent in enumerate(parents) if parent < 0}
    while roots and len(roots) < MOST_PIECES:
        heaviest = max(roots, key=lambda k: (weights[k], k))
        if weights[heaviest] <= PIECE * total:
            break
        roots.remove(heaviest)
        roots.update(children[heaviest])
    return sorted((k - sizes[k] + 1, k) for k in roots)


def _updates(parents: list[int], sizes: list[int], pieces: list[tuple[int, int]]) -> tuple[list[int], int]:
    """Offsets of the fronts' update matrices, and the number of floats for all.

    Updates lie in two stacks, by the parity of the front's depth, so that a front's update never overlaps those of its
    children. Each piece has its own two stacks, and so have the fronts above the pieces.
    """
    depth = [0] * len(parents)
    for k in range(len(parents) - 1, -1, -1):
        depth[k] = depth[parents[k]] + 1 if parents[k] >= 0 else 0
    owner = [len(pieces)] * len(parents)
    for number, (first, root) in enumerate(pieces):
        owner[first : root + 1] = [number] * (root + 1 - first)
    tops = [0] * (2 * len(pieces) + 2)
    most = list(tops)
    found = []
    waiting = [0] * len(parents)
    for k, parent in enumerate(parents):
        stack = 2 * owner[k] + depth[k] % 2
        found.append(tops[stack])
        tops[stack] += sizes[k]
        most[stack] = max(most[stack], tops[stack])
        tops[2 * owner[k] + 1 - depth[k] % 2] -= waiting[k]
        if parent >= 0 and owner[parent] == owner[k]:
            waiting[parent] += sizes[k]
    starts = list(accumulate(most, initial=0))
    return [at + starts[2 * owner[k] + depth[k] % 2] for k, at in enumerate(found)], starts[-1]
