"""Velocities at the start of bodies whose script gives none: what ties ask for beside those that it gives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sceneql.system import Place

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Tied

MOST = 1200
"""Most rows whose velocities are searched; the velocities of larger islands change as little as can be (in energy)."""
FITS = 1e-9
"""Speed that ties may still come apart at, relative to the largest before."""
EASE, ROUNDS = 1e-12, 4
"""Part of the largest diagonal that is added to the matrix of rows, and corrections of what it leaves."""
ROUNDED = 1e-14
"""Component of a velocity, relative to the largest, below which it is rounding."""


def follow(assembly: Assembly, ties: Sequence[Tied], floats: Floats, moved: Mapping[int, int]) -> bool:
    """Give bodies at rest at the start the velocity and spin of least energy by which the ties hold.

    Velocities and spins other than 0 stay: a top that is given its spin alone has its center move about its tip, as a
    blow that gives it this spin would have it (Kelvin 1863: of all motions with given velocities of some parts it is
    the one of least energy). Where ties cannot hold so, all stays. ``floats`` hold the evaluated rows, and at
    ``moved[velocity]``, by where its velocity stands in y, those of each body (tie_rows_kernels). Returns whether
    anything was given.
    """
    import numpy as np
    from scipy.linalg import cho_factor, cho_solve

    from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_J, AT_MASS, AT_SPEED, ROW

    rows = [tie.scratch_at + ROW * k for tie in ties for k in range(len(tie.rows))]
    speeds = floats[np.array(rows) + AT_SPEED]
    fastest = np.abs(speeds).max(initial=0.0)
    if fastest == 0.0 or len(rows) > MOST:
        return False
    y = assembly.start()
    columns: dict[tuple[int, int], int] = {}
    weights: list[Any] = []
    momenta = {one.ints[1]: one.ints[5] for tie in ties for one in tie.movers if isinstance(one, Place)}
    for velocity, at in moved.items():
        momentum = momenta[velocity]
        if floats[at + AT_MASS] > 0.0 and not y[velocity : velocity + 3].any():
            columns[velocity, 0] = 3 * len(columns)
            weights.append(np.sqrt(floats[at + AT_MASS]) * np.eye(3))
        if floats[at + AT_MASS] > 0.0 and momentum >= 0 and not y[momentum : momentum + 3].any():
            columns[velocity, 1] = 3 * len(columns)
            weights.append(np.linalg.cholesky(floats[at + AT_INVERSE : at + AT_INVERSE + 9].reshape(3, 3)))
    whole, row = np.zeros((len(rows), 3 * len(columns))), 0
    for tie in ties:
        for _ in tie.rows:
            for side, mover in enumerate(tie.movers):
                for turns in (0, 1):
                    column = columns.get((mover.ints[1], turns)) if isinstance(mover, Place) else None
                    if column is not None:
                        first = rows[row] + AT_J + 6 * side + 3 * turns
                        whole[row, column : column + 3] += floats[first : first + 3] @ weights[column // 3]
            row += 1
    squares = whole @ whole.T
    squares[np.diag_indices(len(rows))] += EASE * np.diag(squares).max(initial=1e-300)
    factors, left = cho_factor(squares), -speeds
    found = np.zeros(3 * len(columns))
    for _ in range(ROUNDS):  # rows that say the same twice share what they ask for (tie_kernels)
        found += whole.T @ cho_solve(factors, left)
        left = -speeds - whole @ found
    if np.abs(left).max() > FITS * fastest:
        return False
    for (velocity, turns), column in columns.items():
        change, at = weights[column // 3] @ found[column : column + 3], moved[velocity]
        if turns:
            change = np.linalg.solve(floats[at + AT_INVERSE : at + AT_INVERSE + 9].reshape(3, 3), change)
        change[np.abs(change) < ROUNDED * np.abs(change).max()] = 0.0
        assembly.start_at(momenta[velocity] if turns else velocity, change)
    return True
