"""Where the blocks of the matrix of an island's ties stand (tie_matrix_kernels), and the plan of its factorization."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.linear.multifrontal.planning import Plan

WHOLE = 24
"""Most rows whose matrix is dense: as fast as a multifrontal one, and compiled in a tenth of the time."""


@dataclass(frozen=True, slots=True)
class RowsOfTie:
    """The rows of a tie."""

    pair: tuple[int, int]
    """Numbers of its movers."""
    first: int
    end: int
    """Its first row, and the one behind its last."""
    scratch_at: int
    """Offset of the floats of the first."""
    known: int
    """How many movers ties before it have: the first numbers."""

    @property
    def count(self) -> int:
        """How many it has."""
        return self.end - self.first


@dataclass(slots=True)
class TieMatrix:
    """Layout of the matrix of ties."""

    size: int
    """Number of its values."""
    plan: Plan | None
    """Of its factorization, with the values where they stand here; None: it is whole."""
    alone: list[int] = field(default_factory=list)
    """Values that are 1 throughout, where it is not whole: of ties of which no mover is solved, on the diagonal."""
    marks: list[int] = field(default_factory=list)
    """Of each tie (tie_matrix_kernels)."""
    factors: int = 0
    """Number of its factors, where ties are chains."""
    chain: list[list[int]] = field(default_factory=list)
    """Of each tie of chains: parent and children (tie_layout)."""
    shared: list[list[int]] = field(default_factory=list)
    """Integers of each mover that is solved (tie_matrix_kernels), but for BEFORE; HALF is 0 or 1."""


def tie_matrix(sides: Sequence[RowsOfTie], solved: Sequence[bool]) -> TieMatrix:
    """The matrix of ties, of movers of which some are solved."""
    from sceneql.bodies.rigid.ties import tie_layout as kernels

    of_mover: dict[int, list[int]] = {}
    for k, tie in enumerate(sides):
        for mover in tie.pair:
            if solved[mover]:
                of_mover.setdefault(mover, []).append(k)
    pairs = {pair for some in of_mover.values() for pair in product(some, some)} | {(k, k) for k in range(len(sides))}
    chain = _chain(sides, of_mover)
    if chain:
        factors = sum(kernels.of_chain(tie.count) for tie in sides)
        made = TieMatrix(0, None, factors=factors, chain=chain)
        places: dict[tuple[int, int], int] = {}
    else:
        made, places = _whole(sides) if sides[-1].end <= WHOLE else _sparse(sides, pairs)
    last = {mover: some[-1] for mover, some in of_mover.items()}
    order = sorted(of_mover, key=lambda mover: (last[mover], sides[last[mover]].pair.index(mover)))
    for k, tie in enumerate(sides):
        fresh = sum(kernels.FRESH << side for side in range(2) if tie.pair[side] >= tie.known)
        ended = sum(kernels.LAST << side for side in range(2) if last.get(tie.pair[side]) == k)
        of = sum(kernels.SOLVED << side for side in range(2) if solved[tie.pair[side]])
        made.marks.append(fresh + ended + of)
        if made.plan is not None and not any(solved[mover] for mover in tie.pair):
            made.alone += [places[k, k] + (tie.count + 1) * i for i in range(tie.count)]
    if chain:
        return made
    ends = {k: mover for mover in order for k in of_mover[mover]}  # the last mover of each tie
    new = set(places) if made.plan is not None else set()
    for number, mover in enumerate(order):
        own = of_mover[mover]
        numbers = [len(own), mover, 0, number % 2]
        for k in own:
            tie = sides[k]
            numbers += [tie.first, tie.count, tie.scratch_at + 6 * tie.pair.index(mover), int(ends[k] == mover)]
        across = [*product(own, own)]
        numbers += [2 * places[pair] + (pair in new) if pair in places else -1 for pair in across]
        new.difference_update(across)
        made.shared.append(numbers)
    return made


def _chain(sides: Sequence[RowsOfTie], of_mover: dict[int, list[int]]) -> list[list[int]]:
    """Of each tie parent and children (tie_layout), where ties are chains in their order; else nothing."""
    from sceneql.bodies.rigid.ties.tie_layout import MOST_ROWS

    if any(tie.count > MOST_ROWS for tie in sides):
        return []
    found = [[-1, -1, -1] for _ in sides]
    for mover, own in of_mover.items():
        if len(set(own)) < len(own) or len(own) > 2:
            return []
        if len(own) == 2:
            before, behind = own
            if found[before][0] >= 0:
                return []
            found[before][0] = behind
            found[behind][1 + sides[behind].pair.index(mover)] = 2 * before + sides[before].pair.index(mover)
    return found


def _whole(sides: Sequence[RowsOfTie]) -> tuple[TieMatrix, dict[tuple[int, int], int]]:
    """A dense matrix, of which the upper half is read, and where the blocks of pairs of ties begin."""
    from sceneql.bodies.rigid.ties.tie_layout import LANES

    rows = sides[-1].end
    stride = LANES * -(-rows // LANES)
    places = {
        (i, j): one.first * stride + other.first
        for i, one in enumerate(sides)
        for j, other in enumerate(sides)
        if i <= j
    }
    return TieMatrix(rows * stride + stride + LANES, None), places


def _sparse(sides: Sequence[RowsOfTie], pairs: set[tuple[int, int]]) -> tuple[TieMatrix, dict[tuple[int, int], int]]:
    """A planned matrix in the blocks of pairs of ties that are read, and where these begin.

    Behind each block there is room for lanes that reach beyond its last row. A tie's own stands first, then those with
    ties before it.
    """
    import numpy as np
    from scipy.sparse import csr_array

    from sceneql.bodies.rigid.ties.tie_layout import LANES
    from sceneql.linear.multifrontal.planning import plan

    # If all ties have equally many rows, the pattern is that of blocks, whose plan takes far fewer integers.
    counts = {tie.count for tie in sides}
    unit = counts.pop() if len(counts) == 1 else 1
    entries = [
        (i, j, (sides[i].first + r) // unit, (sides[j].first + c) // unit, r, c)
        for i, j in pairs
        for r in range(0, sides[i].count, unit)
        for c in range(0, sides[j].count, unit)
    ]
    ones, others, rows, columns, down, across = np.array(entries, dtype=np.int64).T
    by_place = np.lexsort((columns, rows))
    ones, others, rows, columns, down, across = (some[by_place] for some in (ones, others, rows, columns, down, across))
    pattern = csr_array((np.ones(len(rows)), (rows, columns)), shape=(sides[-1].end // unit,) * 2)
    pattern.sort_indices()
    made = plan(pattern, unit=unit, symmetric=True)
    at = _read(made.numbers)
    values = made.numbers[at] // unit**2
    read = np.unique(values)
    stored = set(zip(ones[read].tolist(), others[read].tolist(), strict=True))
    places: dict[tuple[int, int], int] = {}
    size = 0
    for i, j in sorted(stored, key=lambda pair: (max(pair), pair[0] != pair[1], pair)):
        places[i, j] = size
        size += sides[i].count * sides[j].count + LANES - sides[j].count
    found = np.array([places.get(pair, -1) for pair in zip(ones.tolist(), others.tolist(), strict=True)])
    if unit == 1:
        found += down * np.array([tie.count for tie in sides])[others] + across
    made.numbers[at] = found[values]
    return TieMatrix(size + 2 * LANES, made), places


def _read(planned: NDArray[int64]) -> NDArray[int64]:
    """Where a plan names the first values of the blocks of a symmetric matrix that it reads."""
    import numpy as np

    from sceneql.linear.multifrontal import layout

    starts = layout.HEAD + layout.FIELDS * np.arange(planned[1])
    parts = [
        np.arange(planned[5] + 2 * begin, planned[5] + 2 * end, 2)
        for begin, end in zip(planned[starts + 6].tolist(), planned[starts + 10].tolist(), strict=True)
    ]
    return np.concatenate(parts)
