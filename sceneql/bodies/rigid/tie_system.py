"""All ties of an island together: the term that solves for their forces, and the correction of constraint drift."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import chain
from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Led, Place

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Mover, Slopes, Tied

KERNELS = "sceneql.bodies.rigid.tie_kernels"
KINDS = ("point", "angle", "distance", "gear", "ball", "written", "carried")

IMPLIED, ROUNDING = 1e-10, 1e-13
"""Pivot of a normalized row, the square of its part independent of the rows before, below which the row counts as
dependent; regularization added to the diagonal before the factorization."""
MOST = 600
"""Most constraint rows for which contradictions at the start are searched."""
APART = 1e-6
"""Speed [m/s or rad/s] of a violated tie at the start above which ties contradict each other."""
LEAST = 7
"""Least numbers stored of a row; missing ones are 0."""


def add_ties(assembly: Assembly, ties: Sequence[Tied]) -> None:
    """Add the term of the ties' constraint forces to an island, which acts after all other forces.

    Raises ScriptError where ties contradict each other at the start.
    """
    import numpy as np

    from sceneql.bodies.gears.wheels import geared
    from sceneql.bodies.rigid import tie_matrix_kernels as kernels
    from sceneql.bodies.rigid.tie_kernels import survey
    from sceneql.bodies.rigid.tie_matrix import RowsOfTie, tie_matrix
    from sceneql.bodies.rigid.tie_rows_kernels import MOVED, MOVER, ROW, ROW_INTS
    from sceneql.bodies.rigid.tie_start import follow

    ties = geared(ties, assembly)
    movers: dict[tuple[int, ...], int] = {}
    rows: list[tuple[int, ...]] = []
    sides: list[RowsOfTie] = []
    heads: list[list[int]] = []
    for tie in ties:
        known, of = len(movers), [movers.setdefault(integers(mover), len(movers)) for mover in tie.movers]
        constants = [[*chain(*row.vectors), *row.constants] for row in tie.rows]
        stride = max(LEAST, *map(len, constants))
        numbers_at = assembly.floats([x for some in constants if some for x in (*some, *[0.0] * (stride - len(some)))])
        kinds = [KINDS.index(row.kind) for row in tie.rows]
        packed = sum(kind << kernels.KIND_BITS * k for k, kind in enumerate(kinds))
        heads.append([len(kinds), tie.scratch_at, *of, packed, numbers_at, stride, tie.holds_at])
        sides.append(RowsOfTie((of[0], of[1]), len(rows), len(rows) + len(kinds), tie.scratch_at, known))
        for k, (kind, some) in enumerate(zip(kinds, constants, strict=True)):
            rows.append((kind, *of, numbers_at, tie.scratch_at + ROW * k, tie.holds_at))
            numbers_at += stride if some else 0
    matrix = tie_matrix(sides, [which[0] >= 0 for which in movers])
    for head, marks in zip(heads, matrix.marks, strict=True):
        head.append(marks)
    most = kernels.T_OF * max((some[0] for some in matrix.shared), default=0)
    ease, of_tie = assembly.floats([kernels.EASE]), assembly.floats(np.zeros(2 * most))
    shared_at, ended_at = kernels.HEAD + MOVER * len(movers) + ROW_INTS * len(rows), -1
    for sharers in matrix.shared:
        ended_at, sharers[kernels.BEFORE] = shared_at, ended_at
        sharers[kernels.HALF] = of_tie + most * sharers[kernels.HALF]
        shared_at += len(sharers)
    lists: list[Sequence[int]] = [
        *([number for some in parts for number in some] for parts in (movers, rows, matrix.shared)),
        [] if matrix.plan is None else matrix.plan.numbers.tolist(),
        [*chain(*heads)],
    ]
    begins = np.cumsum([kernels.HEAD, *(len(some) for some in lists)]).tolist()
    spent = (0, 0) if matrix.plan is None else (matrix.plan.factors, 2 * (matrix.plan.work + len(rows)))
    sizes = (MOVED * len(movers), matrix.size, *spent, len(rows))
    moved, values, factors, work, right = (assembly.floats(np.zeros(size)) for size in sizes)
    for at in matrix.alone:
        assembly.write(values + at, [1.0])
    free = not any(isinstance(mover, Led) for tie in ties for mover in tie.movers)
    kept = assembly.floats(np.zeros(kernels.KEPT * len(rows) if free else 0))
    head = [len(movers), len(rows), *begins[:4], len(lists[3])]
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
        len(ties),
        begins[4],
    ]
    head += [assembly.floats(np.ones(len(rows))), ended_at]
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
    assembly.after_step("sceneql.bodies.rigid.tie_settle_kernels:settle", ints, samples=True)
    if free:  # a prescribed motion is known at the end of a step only
        assembly.tied_drift("sceneql.bodies.rigid.rattle_kernels:end_tied", ints)


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
