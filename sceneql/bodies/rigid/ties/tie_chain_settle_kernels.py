# mypy: ignore-errors
"""Ties in chains closed after a step, as in tie_settle_kernels, by the factors that the step has left.

Behind a step, gaps are so small that the matrix of its last evaluation closes them at once (a simplified Newton
iteration: Hairer & Wanner 1996, IV.8). What is not slight, what has not been closed then, and samples, are closed by
factors of their own.
"""

from numba import types

from sceneql.bodies.rigid.ties.tie_chain_hold_kernels import pull
from sceneql.bodies.rigid.ties.tie_chain_kernels import forward, tie_at
from sceneql.bodies.rigid.ties.tie_kernels import AHEAD, SHARE, fetch_tie, left_of, little_of, survey_tie, well
from sceneql.bodies.rigid.ties.tie_layout import (
    CHAIN_AT,
    EASE_AT,
    FIRST_ROW,
    FRESH,
    LAST,
    MARKS,
    MOST_AT,
    MOVED_AT,
    MOVERS_AT,
    ONE,
    RIGHT_AT,
    ROWS,
    ROWS_FROM,
    ROWS_OF,
    TIES,
)
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_A, AT_C, AT_SIZE, AT_SPEED, MOVED, MOVER, ROW
from sceneql.bodies.rigid.ties.tie_settle_kernels import CLOSED, shift_mover, speed_up, weigh_speeds_of
from sceneql.bodies.rigid.ties.tie_settle_kernels import settle as settle_any
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import AFTER_STEP, A, F, I

SLIGHT = 1e-9
"""Gaps and speeds, against the numbers that they are the difference of, up to which factors of the step close them at
once. What they leave of larger speeds is looked at, and closed again."""
MOST_CLOSINGS = 4


@lean(F(A, A, I))
def open_places(y, floats, ints):
    """Write movers and rows, and the first pass of what closes their gaps; the largest, as `survey`."""
    worst = 0.0
    for tie in range(ints[TIES]):
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        worst = max(worst, survey_tie(y, floats, ints, tie))
        at = tie_at(ints, tie)
        to = ints[at + ROWS_FROM]
        row = ints[RIGHT_AT] + ints[at + FIRST_ROW]
        for k in range(row, row + ints[at + ROWS_OF]):
            floats[k] = -floats[to + AT_C]
            to += ROW
        forward(floats, ints, tie)
    return worst


@lean(types.UniTuple(F, 2)(A, A, I, types.boolean))
def open_speeds(y, floats, ints, moved):
    """The first pass of what closes the rows' speeds; the largest gap and speed. ``moved``: movers are written anew."""
    gap = speed = 0.0
    for tie in range(ints[TIES]):
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        if moved:
            gap = max(gap, survey_tie(y, floats, ints, tie))
        speed = max(speed, weigh_speeds_of(floats, ints, tie, ints[tie_at(ints, tie) + FIRST_ROW]))
        forward(floats, ints, tie)
    return gap, speed


@lean(F(A, I))
def open_again(floats, ints):
    """The first pass of what closes the speeds that `close` has left; the largest, as `remaining`."""
    right, worst = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]], 0.0
    for tie in range(ints[TIES]):
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        at = tie_at(ints, tie)
        to, row = ints[at + ROWS_FROM], ints[at + FIRST_ROW]
        worst = max(worst, left_of(floats, ints, tie, row, AT_SPEED, AT_SIZE, right))
        for k in range(row, row + ints[at + ROWS_OF]):
            floats[to + AT_SPEED] = -right[k]
            to += ROW
        for side in range(2):
            if ints[at + MARKS] & (LAST << side):
                m = ints[MOVED_AT] + MOVED * ints[at + ONE + side]
                for k in range(m + AT_A, m + MOVED):
                    floats[k] = 0.0
        forward(floats, ints, tie)
    return worst


@lean(types.void(A, A, I, types.boolean))
def close(y, floats, ints, places):
    """Close what has been opened: places, or speeds."""
    for tie in range(ints[TIES] - 1, -1, -1):
        if tie >= AHEAD:
            fetch_tie(floats, ints, tie - AHEAD)
        pull(floats, ints, tie, False)
        at = tie_at(ints, tie)
        for side in range(2):
            if ints[at + MARKS] & (FRESH << side):
                m = ints[at + ONE + side]
                mover, to = ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m
                if places:
                    shift_mover(y, floats, ints, mover, to)
                else:
                    speed_up(y, floats, ints, mover, to)


@lean(AFTER_STEP, inner=True)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Closes the ties: places and rotations first, then velocities, each by the least change (in energy)."""
    if t0 == t1 or floats[ints[EASE_AT]] != 0.0 or not well(ints, 1.0 / floats[ints[CHAIN_AT] + MOST_AT]):
        return settle_any(t0, t1, y0, rate0, y1, floats, ints)
    gap, changed = open_places(y1, floats, ints), False
    if gap > CLOSED:
        if gap > SLIGHT:
            return settle_any(t0, t1, y0, rate0, y1, floats, ints)
        close(y1, floats, ints, True)
        changed = True
    gap, speed = open_speeds(y1, floats, ints, changed)
    if gap > CLOSED:
        return settle_any(t0, t1, y0, rate0, y1, floats, ints) or changed
    if speed <= CLOSED:
        return changed
    for _ in range(MOST_CLOSINGS):
        close(y1, floats, ints, False)
        if speed <= SLIGHT:
            return True
        speed = open_again(floats, ints)
        if speed <= max(little_of(ints), CLOSED / SHARE):
            return True
    return settle_any(t0, t1, y0, rate0, y1, floats, ints) or True
