"""All ties of an island together: the term that finds their forces, and the closing of what errors have opened."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

from sceneql.system import Led, Place

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Mover, Tied

KERNELS = "sceneql.bodies.rigid.tie_kernels"
KINDS = ("point", "angle", "distance")


def add_ties(assembly: Assembly, ties: Sequence[Tied]) -> None:
    """Add the forces of ties, once all other forces are there."""
    import numpy as np
    from scipy.sparse import csr_array

    from sceneql.bodies.rigid import tie_kernels as kernels
    from sceneql.bodies.rigid.tie_rows_kernels import MOVED, ROW
    from sceneql.linear.multifrontal import plan

    movers: dict[tuple[int, ...], int] = {}
    rows, numbers = [], []
    for tie in ties:
        pair = tuple(movers.setdefault(integers(mover), len(movers)) for mover in tie.movers)
        for k, row in enumerate(tie.rows):
            vectors = [number for vector in row.vectors for number in vector]
            rows.append((KINDS.index(row.kind), *pair, 0, tie.scratch_at + ROW * k))
            numbers.append([*vectors, *([] if row.kind == "point" else [row.constant]), 0.0, 0.0, 0.0][:9])
    numbers_at = assembly.floats(numbers)
    rows = [(kind, a, b, numbers_at + 9 * k, at) for k, (kind, a, b, _, at) in enumerate(rows)]
    solved = [which[0] >= 0 for which in movers]
    of_mover: dict[int, list[tuple[int, int]]] = {}
    for k, (_, a, b, *_) in enumerate(rows):
        for side, mover in enumerate((a, b)):
            if solved[mover]:
                of_mover.setdefault(mover, []).append((k, side))
    parts = [(one, other) for some in of_mover.values() for one, other in product(some, some)]
    scratch = [row[-1] for row in rows]
    own = np.arange(len(rows))
    pattern = csr_array(
        (
            np.ones(len(parts) + len(rows)),
            (
                np.concatenate([[one[0] for one, _ in parts], own]),
                np.concatenate([[other[0] for _, other in parts], own]),
            ),
        ),
        shape=(len(rows), len(rows)),
    )
    pattern.sum_duplicates()
    pattern.sort_indices()
    starts, columns = pattern.indptr, pattern.indices

    def place(row: int, column: int) -> int:
        return int(starts[row] + np.searchsorted(columns[starts[row] : starts[row + 1]], column))

    shared = [
        [len(some), *(scratch[k] + 6 * side for k, side in some), *(place(k, j) for k, _ in some for j, _ in some)]
        for some in of_mover.values()
    ]
    planned = plan(pattern)
    lists: list[Sequence[int]] = [
        [number for which in movers for number in which],
        [number for row in rows for number in row],
        [number for some in shared for number in some],
        [place(k, k) for k in range(len(rows))],
        planned.numbers.tolist(),
    ]
    begins = np.cumsum([kernels.HEAD, *(len(some) for some in lists)]).tolist()
    sizes = (MOVED * len(movers), len(columns), planned.factors, planned.work + len(rows), len(rows))
    moved, values, factors, work, right = (assembly.floats(np.zeros(size)) for size in sizes)
    head = [len(movers), len(rows), begins[0], begins[1], len(shared), begins[2], begins[3], begins[4], len(lists[4])]
    head += [moved, values, sizes[1], factors, sizes[2], work, sizes[3], right]
    ints = tuple(int(number) for number in np.concatenate([head, *lists]))
    assembly.term("tie", f"{KERNELS}:hold", ints)
    assembly.after_step(f"{KERNELS}:settle", ints, samples=True)


def redundant(ties: Sequence[Tied], floats: Floats) -> tuple[int, int]:
    """Conditions of ties, and how many of them the others imply, by what the last evaluation of the rate wrote."""
    import numpy as np

    from sceneql.bodies.rigid.tie_rows_kernels import AT_J, AT_T, ROW

    of_mover: dict[tuple[int, ...], list[tuple[int, int, int]]] = {}
    count = 0
    for tie in ties:
        for k in range(len(tie.rows)):
            for side, mover in enumerate(tie.movers):
                of_mover.setdefault(integers(mover), []).append((count + k, tie.scratch_at + ROW * k, 6 * side))
        count += len(tie.rows)
    whole = np.zeros((count, count))
    for some in of_mover.values():
        rows = [row for row, _, _ in some]
        j, t = (np.array([floats[to + at + side :][:6] for _, to, side in some]) for at in (AT_J, AT_T))
        whole[np.ix_(rows, rows)] += j @ t.T
    sizes = np.sqrt(np.maximum(np.diag(whole), 1e-300))
    return count, count - int(np.linalg.matrix_rank(whole / np.outer(sizes, sizes), tol=1e-9, hermitian=True))


def integers(mover: Mover) -> tuple[int, ...]:
    """The integers of a mover (tie_rows_kernels)."""
    if isinstance(mover, Place):
        position, velocity, _, inverse, rotation, momentum, inertia, _ = mover.ints
        return (position, velocity, inverse, rotation, momentum, inertia, *(6 * (-1,)))
    if isinstance(mover, Led):
        values = (mover.position_at, mover.rotation_at, mover.velocity_at, mover.spin_at)
        return (*(6 * (-1,)), *values, mover.acceleration_at, mover.twist_at)
    return 12 * (-1,)
