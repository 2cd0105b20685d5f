"""All ties of an island together: the term that solves for their forces, and the correction of constraint drift."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import chain, product
from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Led, Place

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Mover, Slopes, Tied

KERNELS = "sceneql.bodies.rigid.tie_kernels"
KINDS = ("point", "angle", "distance", "gear", "ball", "written")

IMPLIED, ROUNDING = 1e-10, 1e-13
"""Pivot of a normalized row, the square of its part independent of the rows before, below which the row counts as
dependent; regularization added to the diagonal before the factorization."""
MOST = 600
"""Most constraint rows for which contradictions at the start are searched."""
APART = 1e-6
"""Speed [m/s or rad/s] of a violated tie at the start above which ties contradict each other."""
WHOLE = 24
"""Most rows whose matrix is dense: as fast as a multifrontal one, and compiled in a tenth of the time."""
LEAST = 7
"""Least numbers stored of a row; missing ones are 0."""


def add_ties(assembly: Assembly, ties: Sequence[Tied]) -> None:
    """Add the term of the ties' constraint forces to an island, which acts after all other forces.

    Raises ScriptError where ties contradict each other at the start.
    """
    import numpy as np
    from scipy.sparse import csr_array

    from sceneql.bodies.rigid import tie_matrix_kernels as matrix
    from sceneql.bodies.rigid.tie_kernels import survey
    from sceneql.bodies.rigid.tie_rows_kernels import MOVED, ROW
    from sceneql.bodies.rigid.tie_start import follow
    from sceneql.linear.multifrontal.planning import plan

    movers: dict[tuple[int, ...], int] = {}
    rows: list[tuple[int, ...]] = []
    sides = []
    for tie in ties:
        pair = tuple(movers.setdefault(integers(mover), len(movers)) for mover in tie.movers)
        sides.append((pair, len(rows), len(tie.rows), tie.scratch_at))
        for k, row in enumerate(tie.rows):
            numbers = [*chain(*row.vectors), *row.constants]
            numbers_at = assembly.floats([*numbers, *(0.0 for _ in range(len(numbers), LEAST))])
            kind = KINDS.index(row.kind)
            rows.append((kind, *pair, numbers_at, tie.scratch_at + ROW * k, tie.holds_at))
    solved = [which[0] >= 0 for which in movers]
    of_mover: dict[int, list[tuple[int, int, int]]] = {}
    for pair, first, count, scratch in sides:
        for side, mover in enumerate(pair):
            if solved[mover]:
                of_mover.setdefault(mover, []).append((first, count, scratch + 6 * side))
    # If all ties have equally many rows, the matrix is stored in blocks, whose plan takes far fewer integers.
    counts, few = {len(tie.rows) for tie in ties}, len(rows) <= WHOLE
    unit = counts.pop() if len(counts) == 1 and not few else 1
    parts = {
        ((one[0] + i) // unit, (other[0] + j) // unit)
        for some in of_mover.values()
        for one, other in product(some, some)
        for i, j in product(range(0, one[1], unit), range(0, other[1], unit))
    }
    blocks = len(rows) // unit
    parts.update(product(range(blocks), range(blocks)) if few else ((k, k) for k in range(blocks)))
    across = np.array(sorted(parts))
    pattern = csr_array((np.ones(len(across)), tuple(across.T)), shape=(blocks, blocks))
    pattern.sort_indices()
    columns = pattern.indices
    starts = [unit * (unit * int(pattern.indptr[k // unit]) + k % unit) for k in range(len(rows))]
    size = unit * unit * len(columns)
    if few:
        stride = matrix.LANES * -(-len(rows) // matrix.LANES)
        starts, size = [k * stride for k in range(len(rows))], stride * len(rows)

    def along(row: int, column: int) -> int:
        """Offset of the value at a column from the first value of the row."""
        first, end = pattern.indptr[row // unit : row // unit + 2]
        return unit * unit * int(np.searchsorted(columns[first:end], column // unit)) + column % unit

    planned = None if few else plan(pattern, unit=unit)
    unread = set() if planned is None else _unread(planned.numbers)

    def place(one: int, rows: int, other: int, columns: int) -> int:
        """Offset of the values of two ties from the first value of a row of the first; -1: they are not read."""
        found = along(one, other)
        block = [starts[one]] if unit > 1 else [starts[one + i] + j for i in range(rows) for j in range(columns)]
        return -1 if (few and one > other) or unread.issuperset(at + found for at in block) else found

    shared = [
        [*(len(some), mover, *chain(*some)), *(place(*one[:2], *other[:2]) for one in some for other in some)]
        for mover, some in of_mover.items()
    ]
    lists: list[Sequence[int]] = [
        [number for which in movers for number in which],
        [number for row in rows for number in row],
        [number for some in shared for number in some],
        starts,
        [starts[k] + along(k, k) for k in range(len(rows))],
        [] if planned is None else planned.numbers.tolist(),
    ]
    begins = np.cumsum([matrix.HEAD, *(len(some) for some in lists)]).tolist()
    spent = (0, 0) if planned is None else (planned.factors, planned.work + len(rows))
    sizes = (MOVED * len(movers), size + matrix.LANES, *spent, len(rows))
    moved, values, factors, work, right = (assembly.floats(np.zeros(size)) for size in sizes)
    head = [len(movers), len(rows), begins[0], begins[1], len(shared), *begins[2:6], len(lists[5])]
    free = not any(isinstance(mover, Led) for tie in ties for mover in tie.movers)
    kept = assembly.floats(np.zeros(matrix.KEPT * len(rows) if free else 0))
    most = max((len(some) for some in of_mover.values()), default=0)
    ease, of_tie = assembly.floats([matrix.EASE]), assembly.floats(np.zeros(most * matrix.T_OF))
    head += [
        moved,
        values,
        sizes[1],
        factors,
        sizes[2],
        work,
        sizes[3],
        right,
        kept,
        ease,
        of_tie,
        len(sides),
        begins[6],
    ]
    lists.append([k for pair, _, n, at in sides for k in (n, at, moved + MOVED * pair[0], moved + MOVED * pair[1])])
    ints = tuple(int(number) for number in np.concatenate([head, *lists]))
    _add_pivots(assembly, ties)
    numbers = assembly.numbers()
    survey(0.0, assembly.start(), numbers, np.array(ints))
    if follow(assembly, ties, numbers, {one[1]: moved + MOVED * k for one, k in movers.items() if one[0] >= 0}):
        survey(0.0, assembly.start(), numbers, np.array(ints))
    if redundant(ties, numbers)[1] == 0:
        assembly.write(ease, [0.0])
    _must_agree(ties, numbers)
    spare = assembly.floats(np.zeros(MOVED))

    def slopes() -> Slopes:
        from sceneql.bodies.rigid.tie_slopes import tie_slopes

        return tie_slopes(ints, spare, len(assembly.start()))

    assembly.term("tie", f"{KERNELS}:hold", ints, slopes)
    assembly.tie_ints = ints
    assembly.after_step(f"{KERNELS}:settle", ints, samples=True)
    if free:  # a prescribed motion is known at the end of a step only
        assembly.tied_drift("sceneql.bodies.rigid.rattle_kernels:end_tied", ints)


def _unread(planned: NDArray[int64]) -> set[int]:
    """The first values of the blocks of a symmetric matrix that a plan for it does not read."""
    from sceneql.linear.multifrontal import layout

    found: set[int] = set()
    entries = int(planned[5])
    for front in range(int(planned[1])):
        at = layout.HEAD + layout.FIELDS * front
        below, end = int(planned[at + 10]), int(planned[at + layout.FIELDS + 6])
        found.update(planned[entries + 2 * below : entries + 2 * end : 2].tolist())
    return found


def _must_agree(ties: Sequence[Tied], floats: Floats) -> None:
    """Raise ScriptError where no velocities satisfy all ties at the start, where ``floats`` hold their evaluation."""
    import numpy as np

    from sceneql.bodies.rigid.tie_rows_kernels import AT_J, AT_SPEED, ROW

    of = [(tie, k) for tie in ties for k in range(len(tie.rows))]
    if len(of) > MOST or not any(isinstance(mover, Led) for tie in ties for mover in tie.movers):
        return
    columns: dict[tuple[int, ...], int] = {}
    whole, speeds = np.zeros((len(of), 12 * len(ties))), np.zeros(len(of))
    for row, (tie, k) in enumerate(of):
        scratch = tie.scratch_at + ROW * k
        speeds[row] = floats[scratch + AT_SPEED]
        for side, mover in enumerate(tie.movers):
            if isinstance(mover, Place) and floats[mover.ints[3]] > 0.0:
                at = 6 * columns.setdefault(integers(mover), len(columns))
                whole[row, at : at + 6] += floats[scratch + AT_J + 6 * side :][:6]
    left = np.abs(speeds - whole @ np.linalg.lstsq(whole, speeds, rcond=1e-9)[0])
    fastest = float(left.max())
    if fastest > APART:
        found = dict.fromkeys(tie.name for (tie, _), one in zip(of, left, strict=True) if one > 0.1 * fastest)
        names = " and ".join(f"'{name}'" for name in found)
        message = f"ties contradict each other at the start: {names} would come apart at {fastest:.3g} m/s (or rad/s)"
        raise ScriptError([Diagnostic("ties-contradict", message, of[int(left.argmax())][0].span)])


def _add_pivots(assembly: Assembly, ties: Sequence[Tied]) -> None:
    """Add the exact free rotation of bodies whose only tie is a ball joint to a fixed point of the world."""
    import numpy as np

    from sceneql.bodies.rigid.turning import packed, principal_axes, quaternion, unpacked

    held = Counter(integers(mover) for tie in ties for mover in tie.movers)
    for tie in ties:
        mine, other = sorted(tie.movers, key=lambda mover: mover is None)
        ball = [row.kind for row in tie.rows] == ["ball", "written", "written"]
        if other is not None or not ball or not isinstance(mine, Place) or held[integers(mine)] > 1:
            continue
        turning, k, numbers = mine.bodies.turning, mine.body, assembly.numbers()
        if turning is None or numbers[mine.bodies.inverse_at + k] == 0.0:
            continue
        mine_first = tie.movers[0] is mine
        arm, point = (
            -np.array(tie.rows[0].vectors[0 if mine_first else 1]),
            tie.rows[0].vectors[1 if mine_first else 0],
        )
        mass = float(numbers[mine.bodies.mass_at + k])
        own = np.linalg.inv(unpacked(numbers[turning.inverse_at + 6 * k :][:6]))
        about = own + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        moments, axes = principal_axes(about)
        assembly.write(turning.principal_at + 7 * k, [0.0])
        offsets = mine.ints
        ints = (
            *(offsets[0], offsets[1], offsets[4], offsets[5], mine.bodies.mass_at + k),
            *(assembly.floats(arm), assembly.floats(point), assembly.floats([*moments, *quaternion(axes)])),
            assembly.floats(packed(np.linalg.inv(about))),
        )
        assembly.free_motion("sceneql.bodies.rigid.free_motion_kernels:pivot", ints, offsets[4], 4)


def redundant(ties: Sequence[Tied], floats: Floats) -> tuple[int, int]:
    """(number of constraint rows, number of dependent ones among them), from the last evaluation in ``floats``."""
    import numpy as np
    from scipy.sparse import csc_array, csr_array
    from scipy.sparse.linalg import splu

    from sceneql.bodies.rigid.tie_rows_kernels import AT_J, ROW

    movers: dict[tuple[int, ...], int] = {}
    parts: list[tuple[int, int, int]] = []
    row = 0
    for tie in ties:
        for side, mover in enumerate(tie.movers):
            if isinstance(mover, Place) and floats[mover.ints[3]] > 0.0:
                column = movers.setdefault(integers(mover), len(movers))
                first = tie.scratch_at + AT_J + 6 * side
                parts += [(row + k, 6 * column, first + ROW * k) for k in range(len(tie.rows))]
        row += len(tie.rows)
    six = np.arange(6)
    rows, columns, places = (np.array([part[k] for part in parts], dtype=np.int64)[:, None] for k in range(3))
    values = floats[places + six]
    # Angular columns are scaled by the longest arm to compare with lengths; masses do not matter.
    values[:, 3:] /= max(1e-300, np.abs(values[:, 3:]).max(initial=0.0))
    shape = (row, 6 * len(movers))
    whole = csr_array((values.ravel(), (np.repeat(rows, 6), (columns + six).ravel())), shape=shape)
    sizes = np.sqrt((whole * whole).sum(axis=1))
    whole = csr_array(whole.multiply(1.0 / np.where(sizes > 0, sizes, 1.0)[:, None]))
    # A pivot is the squared part of a unit row that is orthogonal to the rows before.
    squares = csc_array(whole @ whole.T)
    squares.setdiag(squares.diagonal() + ROUNDING)
    pivots = splu(squares, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return row, int(np.count_nonzero(np.abs(pivots.U.diagonal()) < IMPLIED))


def integers(mover: Mover) -> tuple[int, ...]:
    """The 12 integers of a mover, -1 for missing ones (tie_rows_kernels)."""
    if isinstance(mover, Place):
        position, velocity, _, inverse, rotation, momentum, inertia, _ = mover.ints
        return (position, velocity, inverse, rotation, momentum, inertia, *(6 * (-1,)))
    if isinstance(mover, Led):
        values = (mover.position_at, mover.rotation_at, mover.velocity_at, mover.spin_at)
        return (*(6 * (-1,)), *values, mover.acceleration_at, mover.twist_at)
    return 12 * (-1,)
