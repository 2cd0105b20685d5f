"""Sparsity of the Jacobian of ties, bordered by their multipliers (tie_slopes_kernels.py)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Slopes


def tie_slopes(ints: Sequence[int], spare: int, entries: int) -> Slopes:
    """The Jacobian of the term `tie_kernels.hold` with the integers ``ints``, for a state of ``entries`` numbers.

    ``spare``: offset of working memory for one mover.
    """
    from sceneql.bodies.rigid.ties import tie_layout as ties
    from sceneql.bodies.rigid.ties.tie_rows_kernels import FIRST, MOVER, ROW_INTS, SECOND

    count = ints[ties.ROWS]
    places: list[tuple[int, int]] = []
    for k in range(count):
        at, own, given = ints[ties.ROWS_AT] + ROW_INTS * k, entries + k, entries + count + k
        movers = [ints[ties.MOVERS_AT] + MOVER * ints[at + side] for side in (FIRST, SECOND)]
        moved, acting = _numbers([ints[mover : mover + MOVER] for mover in movers])
        places += [(row, column) for row in acting for column in moved]
        places += [(row, own) for row in acting]
        places += [
            (own, column) for k in range(2) for some in (moved[7 * k :][:7], acting[6 * k :][:6]) for column in some
        ]
        places += [(given if column >= 0 else -1, column) for column in acting]
        places.append((own, own))
    return _slopes("sceneql.bodies.rigid.ties.tie_slopes_kernels:hold", places, [*ints, spare], count)


def drive_slopes(ints: Sequence[int]) -> Slopes:
    """The Jacobian of the term `drive_kernels.drive` with the integers ``ints``."""
    from sceneql.bodies.rigid.ties.tie_rows_kernels import MOVER

    moved, acting = _numbers([ints[:MOVER], ints[MOVER : 2 * MOVER]])
    columns = [column for k in range(2) for some in (moved[7 * k :][:7], acting[6 * k :][:6]) for column in some]
    places = [(row, column) for row in acting for column in columns]
    return _slopes("sceneql.bodies.rigid.drive_slopes_kernels:drive", places, ints, 0)


def _numbers(movers: Sequence[Sequence[int]]) -> tuple[list[int], list[int]]:
    """Indices in y of the movers' positions and quaternions (7 a mover), and of velocities and angular momenta (6).

    -1 for quantities that a mover lacks.
    """
    from sceneql.bodies.rigid.ties.tie_rows_kernels import MOMENTUM, POSITION, ROTATION, VELOCITY

    def of(*parts: tuple[int, int]) -> list[int]:
        return [
            int(mover[which]) + c if mover[POSITION] >= 0 and mover[which] >= 0 else -1
            for mover in movers
            for which, count in parts
            for c in range(count)
        ]

    return of((POSITION, 3), (ROTATION, 4)), of((VELOCITY, 3), (MOMENTUM, 3))


def _slopes(kernel: str, places: Sequence[tuple[int, int]], ints: Sequence[int], border: int) -> Slopes:
    """Slopes with one entry a place (row, column), without the places that contain -1."""
    import numpy as np

    from sceneql.system import Slopes

    rows, columns = np.array(places, dtype=np.int64).T
    there = np.flatnonzero((rows >= 0) & (columns >= 0))
    return Slopes(kernel, rows[there], columns[there], ints, there, border=border)
