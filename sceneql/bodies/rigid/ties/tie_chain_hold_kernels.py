# mypy: ignore-errors
"""The forces of ties in chains (tie_chain_kernels): one sweep along the chains and one back, over all that ties have.

As tie_kernels.hold, but with the numbers of a tie and of its bodies looked at twice in all, the last ones first on the
way back: so of chains that are larger than a cache the part that is still there is used.
"""

import numpy as np
from numba import types

from sceneql.bodies.rigid.ties.tie_chain_kernels import COLUMNS, SIDE, backward, eliminate_turned, tie_at, turn
from sceneql.bodies.rigid.ties.tie_kernels import AHEAD, add, add_to, fetch_tie, little_of, refine, well, write_tie
from sceneql.bodies.rigid.ties.tie_kernels import MOST_CORRECTIONS as MOST
from sceneql.bodies.rigid.ties.tie_layout import (
    CHAIN,
    CHAIN_AT,
    EASE_AT,
    FIRST_ROW,
    FRESH,
    LANES,
    MARKS,
    MOVED_AT,
    MOVERS_AT,
    ONE,
    RIGHT_AT,
    ROWS_FROM,
    ROWS_OF,
    SIDES,
    SOLVED,
    TIES,
)
from sceneql.bodies.rigid.ties.tie_matrix_kernels import begin_matrix, factor_filled
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_A,
    AT_BIAS,
    AT_FORCE,
    AT_PUSHED,
    MOVED,
    MOVER,
    ROW,
    press,
    see,
    weighed_by,
)
from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean
from sceneql.compiled.lanes_kernels import below, fma, load, most, spread, store
from sceneql.system.signatures_kernels import TERM, A, F, I, N

LANE = np.arange(float(LANES))
"""The numbers of the lanes."""
BIASES = SIDE + 6 * LANES
"""Where the biases stand among the columns of J."""


@lean(F(A, I, N))
def left_of(floats, ints, tie):
    """Write -(J a + bias) of a tie's rows to the right hand side; the largest, against the numbers it is a sum of."""
    widest()
    at = tie_at(ints, tie)
    which, columns = ints[at : at + SIDES], floats[ints[CHAIN_AT] + COLUMNS : ints[CHAIN_AT] + CHAIN]
    left = load(columns, BIASES)
    size = abs(left)
    for side in range(2):
        to = ints[MOVED_AT] + MOVED * which[ONE + side] + AT_A
        six, j = floats[to : to + 6], columns[SIDE * side : SIDE * side + 48]
        for c in range(6):
            product = load(j, LANES * c) * six[c]
            left, size = left + product, size + abs(product)
    store(floats, ints[RIGHT_AT] + which[FIRST_ROW], left * -1.0)
    part = below(load(LANE, 0), float(which[ROWS_OF]), abs(left) / (size + 1e-300), spread(0.0))
    return most(part)


@lean(types.void(A, I, N, types.boolean))
def pull(floats, ints, tie, begun):
    """Find the forces of a tie, after its parent's, and what they do to its movers, whose AT_A change once all have.

    ``begun``: as for `backward`.
    """
    widest()
    backward(floats, ints, tie, begun)
    at = tie_at(ints, tie)
    which, first = ints[at : at + SIDES], ints[RIGHT_AT] + ints[at + FIRST_ROW]
    rows, to, scratch = which[ROWS_OF], which[ROWS_FROM], floats[ints[CHAIN_AT] + COLUMNS : ints[CHAIN_AT] + CHAIN]
    x = floats[first : first + rows]
    low = high = spread(0.0)
    for i in range(rows):
        low = fma(x[i], load(floats, to + ROW * i), low)
        high = fma(x[i], load(floats, to + ROW * i + LANES), high)
        floats[to + ROW * i + AT_FORCE] = x[i]
    store(scratch, 0, low)
    store(scratch, LANES, high)
    for side in range(2):
        if which[MARKS] & (SOLVED << side) == 0:
            continue
        moved, push = ints[MOVED_AT] + MOVED * which[ONE + side], scratch[6 * side : 6 * side + 6]
        m = floats[moved : moved + MOVED]
        for c in range(6):
            m[AT_PUSHED + c] += push[c]
        if which[MARKS] & (FRESH << side):
            change = weighed_by(m, m[AT_PUSHED:])
            for c in range(6):
                m[AT_A + c] += change[c]


@lean(F(A, I, N, F))
def take_in(floats, ints, tie, part):
    """Eliminate a tie, its rows and movers being written; what is left of its rows, as `left_of` says."""
    turn(floats, ints, tie)
    left = left_of(floats, ints, tie)
    eliminate_turned(floats, ints, tie, part)
    return left


@lean(TERM, inner=True)
def hold(t, y, rate, floats, ints):
    """Adds the forces [N] and torques [N m] of all ties."""
    part, worst = floats[ints[EASE_AT]], 0.0
    begin_matrix(floats, ints, part)
    for tie in range(ints[TIES]):
        at = tie_at(ints, tie)
        which = ints[at : at + SIDES]
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        for side in range(2):
            if which[MARKS] & (FRESH << side):
                m = which[ONE + side]
                to, at = ints[MOVED_AT] + MOVED * m, ints[MOVERS_AT] + MOVER * m
                see(y, floats, to, ints, at)
                press(y, rate, floats, to, ints, at)
        write_tie(floats, which, ints[MOVED_AT])
        # The tie before: its numbers, written one by one, have reached the cache, where lanes of them are read.
        if tie > 0:
            worst = max(worst, take_in(floats, ints, tie - 1, part))
    worst = max(worst, take_in(floats, ints, ints[TIES] - 1, part))
    least = factor_filled(floats, ints)
    if well(ints, least) and worst > little_of(ints):
        for tie in range(ints[TIES] - 1, -1, -1):
            if tie >= AHEAD:
                fetch_tie(floats, ints, tie - AHEAD)
            pull(floats, ints, tie, True)
            at = tie_at(ints, tie)
            for side in range(2):
                if ints[at + MARKS] & (FRESH << side):
                    m = ints[at + ONE + side]
                    add_to(y, rate, floats, ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m, ints)
        return
    refine(floats, ints, AT_BIAS, AT_BIAS, worst, 0 if least == 0.0 else MOST, True)
    add(y, rate, floats, ints)
