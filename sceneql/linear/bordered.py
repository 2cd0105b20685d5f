"""Plans of block elimination: symmetric factors of many unknowns, as those of elastic solids, and a border of few."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

MOST_FEW = 64
"""Largest number of unknowns of a border: each takes a solution with the factors of the many."""
LEAST_MANY = 300
"""Least number of the many for which a border pays."""


@dataclass(frozen=True, slots=True, eq=False)
class Bordered:
    """Plan of block elimination: integers for bordered_kernels, numbers of floats of factors and scratch."""

    numbers: NDArray[int64]
    factors: int
    work: int


def split(points: Floats) -> NDArray[bool_] | None:
    """Mask (units,) of the many, those at known ``points`` (units, 3); None if a border does not pay."""
    import numpy as np

    many = np.isfinite(points[:, 0])
    count = int(many.sum())
    return many if count >= LEAST_MANY and 0 < len(many) - count <= MOST_FEW else None


def within(pattern: Any, many: NDArray[bool_]) -> Any:
    """Pattern of the many alone, of a symmetric (n, n) scipy CSR pattern, indices sorted."""
    import numpy as np

    chosen = np.flatnonzero(many)
    found = pattern[chosen][:, chosen].tocsr()
    found.sort_indices()
    return found


def bordered(pattern: Any, many: NDArray[bool_], numbers: NDArray[int64], factors: int, work: int) -> Bordered:
    """Plan of a system on a ``pattern`` whose part `within` is factored by systems_kernels.

    ``numbers``, ``factors``, ``work``: the plan of that part.
    """
    import numpy as np

    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.linear.bordered_kernels import HEAD
    from sceneql.linear.multifrontal import systems_kernels
    from sceneql.linear.solver_kernels import FACTOR_SYSTEM, SOLVE_SYSTEM

    size = len(many)
    chosen, others = np.flatnonzero(many), np.flatnonzero(~many)
    rank = np.empty(size, dtype=np.int64)
    rank[chosen], rank[others] = np.arange(len(chosen)), np.arange(len(others))
    rows = np.repeat(np.arange(size, dtype=np.int64), np.diff(pattern.indptr))
    columns = pattern.indices.astype(np.int64)
    own = np.flatnonzero(many[rows] & many[columns])
    twins = np.lexsort((rows[own], columns[own]))  # values row by row, so by columns these are the transposed ones

    def part(mask: NDArray[bool_]) -> NDArray[int64]:
        places = np.flatnonzero(mask)
        return np.column_stack([places, rank[rows[places]], rank[columns[places]]]).ravel()

    parts = [part(many[rows] & ~many[columns]), part(~many[rows] & many[columns]), part(~many[rows] & ~many[columns])]
    lists = [chosen, others, own, twins, np.zeros(len(others), dtype=np.int64), *parts, numbers]
    starts = list(accumulate((len(one) for one in lists), initial=HEAD))
    kernels = (
        number_of(systems_kernels.factor_system, FACTOR_SYSTEM),
        number_of(systems_kernels.solve_system, SOLVE_SYSTEM),
    )
    head = [len(chosen), len(others), len(own), *kernels, 0, factors, work, *starts[:5]]
    head += [number for k in range(3) for number in (len(parts[k]) // 3, starts[5 + k])] + [starts[8]]
    assert len(head) == HEAD
    few, count = len(others), len(chosen)
    together = np.concatenate([np.asarray(one, dtype=np.int64) for one in (head, *lists)])
    return Bordered(together, factors + len(own) + count * few + few * few, work + size)
