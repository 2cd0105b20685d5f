# mypy: ignore-errors
"""Ties in chains, of which no body has more than two: their matrix J T (tie_matrix_kernels) is never written.

With the ties in an order in which each has at most one behind it that shares a body, its parent, elimination fills in
nothing (Parter 1961): a tie's own block less what its children leave is factored as U^T D^-1 U, and W = U^-T D C is
what its block C with its parent becomes. Each of its rows is eliminated in one register, with its right hand side.

Of a tie of n rows there are 2 n LANES of factors: n of U, with D^-1 in lane INVERSE and U^-T times the right hand side
in lane GIVEN, then n of W.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_layout import (
    CHAIN,
    CHAIN_AT,
    CHILDREN,
    COLUMNS,
    DEPENDENT_AT,
    DIAGONAL_AT,
    FACTORS_FROM,
    FIRST_ROW,
    LANES,
    MARKS,
    MOST_AT,
    MOVED_AT,
    ONE,
    PARENT,
    RIGHT_AT,
    ROWS,
    ROWS_FROM,
    ROWS_OF,
    SIDES,
    SOLVED,
    TIES,
    TIES_AT,
    WEIGHED,
)
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_MASS, MOVED, ROW
from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import fma, load, spread, store, turn_over, with_lane
from sceneql.system.signatures_kernels import A, F, I, N

INVERSE, GIVEN = 6, 7
"""Lanes behind those of the rows."""
NONE = 1e-100
"""Size below which a force or a part of one counts as none. Along a chain what begins at one end dies away by a factor
a tie: hundreds of ties on it would be subnormal, and then its products, each of which takes some hundred cycles."""
SIDE = 64
"""Numbers of the columns by one mover: six of J, and by the second one the bias behind them."""


@lean_inlined
def some(force):
    """A force, 0 where it counts as none."""
    return force if abs(force) > NONE else 0.0


@lean_inlined
def tie_at(ints, tie):
    """Where the integers of a tie begin."""
    return ints[TIES_AT] + SIDES * tie


@lean_inlined
def weigh(floats, mover, scratch, side):
    """Write T of the tie whose J are turned over, by one of its movers, of the floats from ``mover`` on."""
    m = floats[mover + AT_INVERSE : mover + AT_MASS + 1]
    j, t = scratch[COLUMNS + SIDE * side :], scratch[WEIGHED + 48 * side :]
    inverse = m[AT_MASS - AT_INVERSE]
    store(t, 0, load(j, 0) * inverse)
    store(t, 8, load(j, 8) * inverse)
    store(t, 16, load(j, 16) * inverse)
    u, v, w = load(j, 24), load(j, 32), load(j, 40)
    store(t, 24, fma(m[6], w, fma(m[3], v, m[0] * u)))
    store(t, 32, fma(m[7], w, fma(m[4], v, m[1] * u)))
    store(t, 40, fma(m[8], w, fma(m[5], v, m[2] * u)))


@lean_inlined
def join(floats, to, rows, at, t):
    """Write W of a tie of ``rows`` rows at floats[to:] and factors at floats[at:], and T of its parent: U^-T D J T."""
    a, b, c, d, e, f = load(t, 0), load(t, 8), load(t, 16), load(t, 24), load(t, 32), load(t, 40)
    u = floats[at : at + 2 * LANES * rows]
    w = u[LANES * rows :]
    for i in range(rows):
        six = floats[to + ROW * i : to + ROW * i + 6]
        row = fma(six[2], c, fma(six[1], b, six[0] * a)) + fma(six[5], f, fma(six[4], e, six[3] * d))
        for k in range(i):
            row = fma(-(u[LANES * k + i] * u[LANES * k + INVERSE]), load(w, LANES * k), row)
        store(w, LANES * i, with_lane(row, GIVEN, u[LANES * i + GIVEN]))


@lean(types.void(A, I, N))
def turn(floats, ints, tie):
    """Write J of a tie in columns."""
    to, columns = ints[tie_at(ints, tie) + ROWS_FROM], floats[ints[CHAIN_AT] + COLUMNS : ints[CHAIN_AT] + WEIGHED]
    turn_over(floats, to, ROW, columns, 0, LANES)
    turn_over(floats, to + 6, ROW, columns, SIDE, LANES)


@lean(types.void(A, I, N, F))
def eliminate_turned(floats, ints, tie, part):
    """Factor a tie, after those before it: J, the right hand side and its movers are written, J in columns too.

    ``part`` of its diagonal is added to it.
    """
    widest()
    at = tie_at(ints, tie)
    scratch, which = floats[ints[CHAIN_AT] : ints[CHAIN_AT] + CHAIN], ints[at : at + SIDES]
    rows, to, marks = which[ROWS_OF], which[ROWS_FROM], which[MARKS]
    own = floats[which[FACTORS_FROM] : which[FACTORS_FROM] + 2 * LANES * rows]
    right = floats[ints[RIGHT_AT] + which[FIRST_ROW] : ints[RIGHT_AT] + which[FIRST_ROW] + rows]
    diagonal = floats[ints[DIAGONAL_AT] + which[FIRST_ROW] : ints[DIAGONAL_AT] + which[FIRST_ROW] + rows]
    for i in range(rows):
        store(own, LANES * i, with_lane(spread(0.0), GIVEN, right[i]))
    for side in range(2):
        if marks & (SOLVED << side) == 0:
            continue
        weigh(floats, ints[MOVED_AT] + MOVED * which[ONE + side], scratch, side)
        t = scratch[WEIGHED + 48 * side :]
        a, b, c, d, e, f = load(t, 0), load(t, 8), load(t, 16), load(t, 24), load(t, 32), load(t, 40)
        for i in range(rows):
            six = floats[to + ROW * i + 6 * side : to + ROW * i + 6 * side + 6]
            sums = fma(six[2], c, fma(six[1], b, six[0] * a)) + fma(six[5], f, fma(six[4], e, six[3] * d))
            store(own, LANES * i, with_lane(load(own, LANES * i) + sums, GIVEN, right[i]))
    for i in range(rows):
        value = own[LANES * i + i]
        if part > 0.0 or not value > 0.0:
            # A row that no mass can meet, as of two parts that are led, has no force.
            value = own[LANES * i + i] = value * (1.0 + part) if value > 0.0 else 1.0
        diagonal[i] = value
    for side in range(2):
        if which[CHILDREN + side] >= 0:
            at, low = tie_at(ints, which[CHILDREN + side] >> 1), 6 * (which[CHILDREN + side] & 1)
            child = ints[at : at + SIDES]
            join(floats, child[ROWS_FROM] + low, child[ROWS_OF], child[FACTORS_FROM], scratch[WEIGHED + 48 * side :])
            count = child[ROWS_OF]
            u = floats[child[FACTORS_FROM] : child[FACTORS_FROM] + 2 * LANES * count]
            w = u[LANES * count :]
            for i in range(rows):
                row = load(own, LANES * i)
                for k in range(count):
                    row = fma(-(w[LANES * k + i] * u[LANES * k + INVERSE]), load(w, LANES * k), row)
                store(own, LANES * i, row)
    most, least = scratch[MOST_AT], scratch[DEPENDENT_AT]
    for i in range(rows):
        row = load(own, LANES * i)
        for k in range(i):
            row = fma(-(own[LANES * k + i] * own[LANES * k + INVERSE]), load(own, LANES * k), row)
        store(own, LANES * i, row)
        pivot, given = own[LANES * i + i], own[LANES * i + GIVEN]
        if not least * diagonal[i] < pivot < math.inf:
            most = math.inf
        inverse = 1.0 / pivot if pivot != 0.0 else 0.0
        most = max(most, inverse * diagonal[i])
        store(own, LANES * i, with_lane(with_lane(row, INVERSE, inverse), GIVEN, some(given)))
    scratch[MOST_AT] = most


@lean(types.void(A, I, N, F), inner=True)
def eliminate(floats, ints, tie, part):
    """`eliminate_turned`, J being written in rows alone."""
    turn(floats, ints, tie)
    eliminate_turned(floats, ints, tie, part)


@lean(types.void(A, I, N))
def forward(floats, ints, tie):
    """The first pass of a solution over a tie, after those before it, in the right hand side."""
    at = tie_at(ints, tie)
    which, right = ints[at : at + SIDES], floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    rows, first = which[ROWS_OF], which[FIRST_ROW]
    own, x = floats[which[FACTORS_FROM] : which[FACTORS_FROM] + LANES * rows], right[first : first + rows]
    for side in range(2):
        if which[CHILDREN + side] >= 0:
            at = tie_at(ints, which[CHILDREN + side] >> 1)
            child = ints[at : at + SIDES]
            count, y = child[ROWS_OF], right[child[FIRST_ROW] : child[FIRST_ROW] + child[ROWS_OF]]
            u = floats[child[FACTORS_FROM] : child[FACTORS_FROM] + 2 * LANES * count]
            for k in range(count):
                value = y[k] * u[LANES * k + INVERSE]
                w = u[LANES * (count + k) : LANES * (count + k + 1)]
                for i in range(rows):
                    x[i] -= w[i] * value
    for k in range(rows):
        x[k] = some(x[k])
        value = x[k] * own[LANES * k + INVERSE]
        for i in range(k + 1, rows):
            x[i] -= own[LANES * k + i] * value


@lean(types.void(A, I, N, types.boolean))
def backward(floats, ints, tie, begun):
    """The second pass of a solution over a tie, after its parent, in the right hand side.

    ``begun``: `eliminate` has taken the first pass, for the right hand side that there was.
    """
    at = tie_at(ints, tie)
    which, right = ints[at : at + SIDES], floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    rows, first = which[ROWS_OF], which[FIRST_ROW]
    own, x = floats[which[FACTORS_FROM] : which[FACTORS_FROM] + 2 * LANES * rows], right[first : first + rows]
    if begun:
        for i in range(rows):
            x[i] = own[LANES * i + GIVEN]
    if which[PARENT] >= 0:
        at = tie_at(ints, which[PARENT])
        z = right[ints[at + FIRST_ROW] : ints[at + FIRST_ROW] + ints[at + ROWS_OF]]
        for i in range(rows):
            w, total = own[LANES * (rows + i) : LANES * (rows + i + 1)], 0.0
            for j in range(z.size):
                total += w[j] * z[j]
            x[i] -= total
    for i in range(rows - 1, -1, -1):
        total = x[i]
        for j in range(rows - 1, i, -1):
            total -= own[LANES * i + j] * x[j]
        x[i] = some(total * own[LANES * i + INVERSE])


@lean(types.void(A, I, types.boolean), inner=True)
def solve(floats, ints, begun):
    """Solve with the factors, in place; ``begun``: for the right hand side that there was when they were made."""
    if not begun:
        for tie in range(ints[TIES]):
            forward(floats, ints, tie)
    for tie in range(ints[TIES] - 1, -1, -1):
        backward(floats, ints, tie, begun)
