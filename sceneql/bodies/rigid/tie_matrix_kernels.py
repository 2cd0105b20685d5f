# mypy: ignore-errors
"""The matrix J T of all ties of an island: its layout, its values and its factors.

J are the rows of ties and T = J^T / M, with M the masses: it is positive semidefinite, sparse by the bodies that rows
share.
"""

import numpy as np
from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import AT_J, MOVED, ROW, weighed_by
from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import fma, load, store
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal import layout
from sceneql.system.signatures_kernels import A, F, I, N

# Compiled at the first system of many rows, or of few.
factor_sparse = lazy("sceneql.linear.multifrontal.symmetric_kernels:factor_symmetric", types.boolean(I, A, A, A))
solve_sparse = lazy("sceneql.linear.multifrontal.solve_kernels:solve_symmetric", types.void(I, A, A, A))
factor_dense = lazy("sceneql.linear.dense_symmetric_kernels:factor", F(A, N, N, F))
solve_dense = lazy("sceneql.linear.dense_symmetric_kernels:solve", types.void(A, N, N, A))

MOVERS, ROWS, MOVERS_AT, ROWS_AT, SHARED, SHARED_AT, STARTS_AT, DIAGONAL_AT, PLAN_AT, PLAN = range(10)
MOVED_AT, VALUES_AT, VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, KEPT_AT, EASE_AT, TIE_AT, TIES = range(
    10, 22
)
TIES_AT, HEAD = 22, 23
"""Integers of an island's ties: numbers of movers, rows, movers that ties share, of the plan's integers, and where
each begins; the first values of the matrix's rows, and the places of its diagonal's; offsets into the floats and sizes
of what movers, matrix, factors, scratch and right hand side take, and what drifts keep (rattle_kernels); of EASE; of T
of a tie; the number of ties and where their SIDES begin: how many rows, offsets of the floats of these and of both
movers. Few rows have a matrix that is whole, its factors in place, and no plan. A mover that ties share: their number
n and its own; of each tie OF_TIE: its first row, how many it has, their floats at its side; then n x n places in a row
of the first where the rows of the second begin, counted from that row's first value (-1: what stands there is not
read)."""
OF_TIE = 3
ROWS_OF, ROWS_FROM, ONE, OTHER, SIDES = range(5)
LANES, T_OF = 8, 48
"""Columns of T of a tie, of which those behind its rows are 0; its numbers."""
UPPER = np.triu(np.ones((LANES, LANES))).ravel()
"""Of a block's rows: 0 below the diagonal."""
KEPT = 12
"""Floats of a row that drifts keep of where they began: J."""
EASE, LITTLE, DEPENDENT = 1e-9, 1e-13, 1e-12
"""Part of the diagonal that is added to it, at floats[ints[EASE_AT]]: none where no row follows from others at the
start, so that light bodies may hold heavy ones, but LITTLE where a pivot is not above that part of its diagonal."""


@lean_inlined
def add_block(values, begins, place, floats, to, t, upper):
    """Add J of a tie, at floats[to:] and behind, times T of another to their block.

    ``place``: of its values in the rows that begin at ``begins``; ``upper``: to its upper half alone.
    """
    a, b, c, d, e, f = load(t, 0), load(t, LANES), load(t, 16), load(t, 24), load(t, 32), load(t, 40)
    for i in range(begins.size):
        six, at = floats[to + ROW * i : to + ROW * i + 6], begins[i] + place
        sums = fma(six[2], c, fma(six[1], b, six[0] * a)) + fma(six[5], f, fma(six[4], e, six[3] * d))
        if upper:
            sums = sums * load(UPPER, LANES * i)
        store(values, at, load(values, at) + sums)


@lean(types.void(A, I))
def fill(floats, ints):
    """Write J T, at least the half of it that is read."""
    widest()
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    for k in range(values.size):
        values[k] = 0.0
    at, starts = ints[SHARED_AT], ints[STARTS_AT]
    # Of a tie's own block the other half is read where its rows are eliminated in any order.
    half = ints[FACTORS] > 0 and ints[ints[PLAN_AT] + layout.UNIT] > 1
    for _ in range(ints[SHARED]):
        count, mover = ints[at], ints[MOVED_AT] + MOVED * ints[at + 1]
        table = at + 2 + OF_TIE * count
        m = floats[mover : mover + MOVED]
        for k in range(count):
            which = ints[at + 2 + OF_TIE * k : at + 2 + OF_TIE * (k + 1)]
            own, t = which[2] + AT_J, floats[ints[TIE_AT] + T_OF * k : ints[TIE_AT] + T_OF * (k + 1)]
            for j in range(which[1]):
                x, y, z, u, v, w = weighed_by(m, floats[own + ROW * j : own + ROW * j + 6])
                t[j], t[j + 8], t[j + 16], t[j + 24], t[j + 32], t[j + 40] = x, y, z, u, v, w
            for j in range(which[1], LANES):
                t[j] = t[j + 8] = t[j + 16] = t[j + 24] = t[j + 32] = t[j + 40] = 0.0
        for other in range(count):
            which = ints[at + 2 + OF_TIE * other : at + 2 + OF_TIE * (other + 1)]
            columns, beyond = ints[starts + which[0] : starts + which[0] + which[1]], which[2] + AT_J
            t = floats[ints[TIE_AT] + T_OF * other : ints[TIE_AT] + T_OF * (other + 1)]
            for one in range(other + 1):
                which = ints[at + 2 + OF_TIE * one : at + 2 + OF_TIE * (one + 1)]
                rows = ints[starts + which[0] : starts + which[0] + which[1]]
                across, along = ints[table + count * one + other], ints[table + count * other + one]
                if across >= 0:
                    add_block(values, rows, across, floats, which[2] + AT_J, t, half and one == other)
                if along >= 0 and one != other:
                    first = floats[ints[TIE_AT] + T_OF * one : ints[TIE_AT] + T_OF * (one + 1)]
                    add_block(values, columns, along, floats, beyond, first, False)
        at = table + count * count


@lean_inlined
def stride(ints):
    """Numbers of a row of the whole matrix, whose rows end with those that only lanes reach."""
    return LANES * ((ints[ROWS] + LANES - 1) // LANES)


@lean_inlined
def least_pivot(values, factors, ints, plan):
    """The least part of its diagonal that a pivot of sparse factors is; 0 where one is not above 0."""
    least = 1.0
    for s in range(plan[1]):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height, panel = plan[t], plan[t + 1], plan[t + 2], plan[t + 5]
        for k in range(width):
            diagonal = values[ints[ints[DIAGONAL_AT] + plan[plan[2] + first + k]]]
            inverse = factors[panel + k * (height + 1)]
            least = min(least, 1.0 / (inverse * diagonal)) if inverse > 0.0 else 0.0
    return least


@lean(F(A, I, F))
def factor_with(floats, ints, part):
    """Factor J T with a part of its diagonal added; the least part of it that a pivot is, at most what is added.

    0 where the matrix cannot be factored, or, without what is added, where rows depend.
    """
    fill(floats, ints)
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    for k in range(ints[ROWS]):
        place = ints[ints[DIAGONAL_AT] + k]
        # A row that no mass can meet, as of two parts that are led, has no force.
        values[place] = values[place] * (1.0 + part) if values[place] > 0.0 else 1.0
    if ints[FACTORS] == 0:
        least = factor_dense(values, ints[ROWS], stride(ints), DEPENDENT if part == 0.0 else 0.0)
        return least if part == 0.0 else min(least, part)
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    if not factor_sparse(plan, values, factors, work):
        return 0.0
    least = part if part > 0.0 else least_pivot(values, factors, ints, plan)
    return least if least > DEPENDENT else 0.0


@lean(F(A, I))
def factor(floats, ints):
    """Factor J T; the least part of its diagonal that a pivot is, 0 where it cannot be factored.

    Where rows depend on others EASE of the diagonal is added, and LITTLE where they have only come to do so.
    """
    part = floats[ints[EASE_AT]]
    least = factor_with(floats, ints, part)
    return factor_with(floats, ints, LITTLE) if least == 0.0 and part == 0.0 else least


@lean(types.void(A, I))
def solve(floats, ints):
    """Solve with the factors, in place."""
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    if ints[FACTORS] == 0:
        solve_dense(floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]], ints[ROWS], stride(ints), right)
        return
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    solve_sparse(plan, factors, right, work)
