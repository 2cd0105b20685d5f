# mypy: ignore-errors
"""The matrix J T of all ties of an island: its layout, its values and its factors.

J are the rows of ties and T = J^T / M, with M the masses: it is positive semidefinite, sparse by the bodies that rows
share.
"""

import numpy as np
from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import AT_INVERSE, AT_MASS, MOVED, ROW
from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import fma, load, store
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal import layout
from sceneql.system.signatures_kernels import A, F, I, N

# Compiled at the first system of many rows, or of few.
SPARSE = "sceneql.linear.multifrontal.factor_solve_kernels"
factor_sparse = lazy(f"{SPARSE}:factor_up", F(I, A, A, A, A, A))
solve_sparse = lazy(f"{SPARSE}:solve_after", types.void(I, A, A, A, types.boolean))
factor_dense = lazy("sceneql.linear.dense_symmetric_kernels:factor", F(A, N, N, F))
solve_dense = lazy("sceneql.linear.dense_symmetric_kernels:solve", types.void(A, N, N, A))

MOVERS, ROWS, MOVERS_AT, ROWS_AT, SHARED_AT, PLAN_AT, PLAN = range(7)
MOVED_AT, VALUES_AT, VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, KEPT_AT, EASE_AT, TIE_AT, TIES = range(7, 19)
TIES_AT, DIAGONAL_AT, ENDED_AT, HEAD = 19, 20, 21, 22
"""Integers of an island's ties: numbers of movers and rows; where the integers of both, of the movers that ties share
and of the plan begin, and how many the last are; offsets into the floats and sizes of what movers, matrix, factors,
scratch and right hand side take, and what drifts keep (rattle_kernels); of EASE; of T of a tie; the number of ties and
where their SIDES begin; the offset of the matrix's diagonal; where the last of what follows begins. Few rows have a
matrix that is whole, its factors in place, and no plan; else it is in blocks of two ties (rows of one x rows of the
other), as they are read. A mover that ties share: their number n and its own; where the one before begins (-1: none),
and which half of T it has; of each tie OF_TIE: its first row, how many it has, their floats at its side, whether its
own block is complete with this mover; then n x n, twice where the block of two ties begins (-1: it is not read), and 1
where nothing is there yet. They stand in the order in which ties have had all of theirs."""
SHARERS, SHARED_MOVER, BEFORE, HALF, OF_SHARED = range(5)
OF_TIE = 4
ROWS_OF, ROWS_FROM, ONE, OTHER, KINDS, NUMBERS_FROM, STRIDE, TIE_HOLDS, MARKS, SIDES = range(10)
"""Integers of a tie: how many rows, offset of the first one's floats; its movers; the kinds of its rows, KIND_BITS
each, the first one lowest; offset of the numbers of the first one, and of each further one that has some from there; of
whether it holds; marks."""
KIND_BITS = 3
FRESH, LAST = 1, 4
"""Marks of ONE, and times 2 of OTHER: no tie before has this mover; none behind has it, and it is solved."""
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
def add_block(values, at, along, rows, floats, to, t, upper, new):
    """Add J of a tie, of ``rows`` rows at floats[to:], times T of another to their block, with rows ``along`` apart.

    ``upper``: to its upper half alone; ``new``: nothing is there yet.
    """
    a, b, c, d, e, f = load(t, 0), load(t, LANES), load(t, 16), load(t, 24), load(t, 32), load(t, 40)
    if not new:
        known = load(values, at)
        for i in range(rows):
            six = floats[to + ROW * i : to + ROW * i + 6]
            sums = fma(six[2], c, fma(six[1], b, six[0] * a)) + fma(six[5], f, fma(six[4], e, six[3] * d))
            # Read before a row that reaches into the next one is written, which would have to be waited for.
            following = load(values, at + along)
            store(values, at, known + (sums * load(UPPER, LANES * i) if upper else sums))
            known = following
            at += along
        return
    for i in range(rows):
        six = floats[to + ROW * i : to + ROW * i + 6]
        sums = fma(six[2], c, fma(six[1], b, six[0] * a)) + fma(six[5], f, fma(six[4], e, six[3] * d))
        store(values, at, sums * load(UPPER, LANES * i) if upper else sums)
        at += along


@lean_inlined
def stride(ints):
    """Numbers of a row of the whole matrix, whose rows end with those that only lanes reach."""
    return LANES * ((ints[ROWS] + LANES - 1) // LANES)


@lean_inlined
def end_diagonal(values, at, along, diagonal, part):
    """Add a part to the diagonal of a block that is complete, and keep it."""
    for i in range(diagonal.size):
        # A row that no mass can meet, as of two parts that are led, has no force.
        value = values[at] * (1.0 + part) if values[at] > 0.0 else 1.0
        values[at] = diagonal[i] = value
        at += along + 1


@lean(types.void(A, I, N))
def weigh(floats, ints, at):
    """Write T of all ties that share the mover of ints[at:]."""
    mover, half, first = ints[MOVED_AT] + MOVED * ints[at + SHARED_MOVER], ints[at + HALF], at + OF_SHARED
    m = floats[mover + AT_INVERSE : mover + AT_MASS + 1]
    xx, yx, zx, xy, yy, zy = m[0], m[1], m[2], m[3], m[4], m[5]
    xz, yz, zz, inverse = m[6], m[7], m[8], m[AT_MASS - AT_INVERSE]
    for _ in range(ints[at + SHARERS]):
        rows, own, t = ints[first + 1], ints[first + 2], floats[half : half + T_OF]
        for j in range(rows):
            six = floats[own : own + 6]
            a, b, c, u, v, w = six[0], six[1], six[2], six[3], six[4], six[5]
            t[j], t[j + 8], t[j + 16] = inverse * a, inverse * b, inverse * c
            t[j + 24], t[j + 32] = xx * u + yx * v + zx * w, xy * u + yy * v + zy * w
            t[j + 40] = xz * u + yz * v + zz * w
            own += ROW
        for j in range(rows, LANES):
            t[j] = t[j + 8] = t[j + 16] = t[j + 24] = t[j + 32] = t[j + 40] = 0.0
        half += T_OF
        first += OF_TIE


@lean(types.void(A, I, N, F))
def add_blocks(floats, ints, at, part):
    """Add what the ties that share the mover of ints[at:] have of J T by it, once their T is written."""
    widest()
    values, whole = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]], ints[FACTORS] == 0
    # Of a tie's own block the other half is read where its rows are eliminated in any order.
    own_half = not whole and ints[ints[PLAN_AT] + layout.UNIT] > 1
    count, half, line = ints[at + SHARERS], ints[at + HALF], stride(ints)
    table = at + OF_SHARED + OF_TIE * count
    for one in range(count):
        which = ints[at + OF_SHARED + OF_TIE * one : at + OF_SHARED + OF_TIE * (one + 1)]
        for other in range(count):
            place = ints[table + count * one + other]
            if place < 0:
                continue
            t, rows = floats[half + T_OF * other : half + T_OF * (other + 1)], which[1]
            along = line if whole else ints[at + OF_SHARED + OF_TIE * other + 1]
            upper = own_half and one == other
            add_block(values, place >> 1, along, rows, floats, which[2], t, upper, place & 1 == 1)
            if one == other and which[3] == 1 and not whole:
                diagonal = floats[ints[DIAGONAL_AT] + which[0] : ints[DIAGONAL_AT] + which[0] + rows]
                end_diagonal(values, place >> 1, along, diagonal, part)


@lean_inlined
def add_mover(floats, ints, at, part):
    """Add a mover whose ties are all written to J T; where the next one stands."""
    weigh(floats, ints, at)
    # T of the one before has reached the cache: lanes of what was written number by number just now must wait.
    if ints[at + BEFORE] >= 0:
        add_blocks(floats, ints, ints[at + BEFORE], part)
    return at + OF_SHARED + (OF_TIE + ints[at + SHARERS]) * ints[at + SHARERS]


@lean_inlined
def begin_matrix(floats, ints):
    """Zero J T where it is whole; where the first mover stands that ties share."""
    if ints[FACTORS] == 0:
        values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
        for k in range(values.size):
            values[k] = 0.0
    return ints[SHARED_AT]


@lean_inlined
def add_tie(floats, ints, tie, at, part):
    """Write of J T what the rows of a tie make known; ``at`` and what it returns: as `add_mover`."""
    marks = ints[ints[TIES_AT] + SIDES * tie + MARKS]
    if marks & LAST:
        at = add_mover(floats, ints, at, part)
    if marks & (2 * LAST):
        at = add_mover(floats, ints, at, part)
    return at


@lean_inlined
def end_matrix(floats, ints, part):
    """Add the last of the movers to J T, and end the diagonal where it is whole."""
    if ints[ENDED_AT] >= 0:
        add_blocks(floats, ints, ints[ENDED_AT], part)
    if ints[FACTORS] == 0:
        values, along = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]], stride(ints)
        diagonal = floats[ints[DIAGONAL_AT] : ints[DIAGONAL_AT] + ints[ROWS]]
        end_diagonal(values, 0, along, diagonal, part)


@lean(types.void(A, I, F))
def fill(floats, ints, part):
    """Write J T, at least the half of it that is read, with a part of its diagonal added."""
    at = begin_matrix(floats, ints)
    for tie in range(ints[TIES]):
        at = add_tie(floats, ints, tie, at, part)
    end_matrix(floats, ints, part)


@lean(F(A, I, F))
def factor_with(floats, ints, part):
    """Factor J T, with a part of its diagonal added; the least part of it that a pivot is, at most what is added.

    0 where the matrix cannot be factored, or, without what is added, where rows depend. If the matrix is not whole, the
    first half of `solve` is done, too.
    """
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    if ints[FACTORS] == 0:
        least = factor_dense(values, ints[ROWS], stride(ints), DEPENDENT if part == 0.0 else 0.0)
        return least if part == 0.0 else min(least, part)
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    diagonal = floats[ints[DIAGONAL_AT] : ints[DIAGONAL_AT] + ints[ROWS]]
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    least = factor_sparse(plan, values, factors, work, diagonal, right)
    if part > 0.0:
        return part if least >= 0.0 else 0.0
    return least if least > DEPENDENT else 0.0


@lean(F(A, I))
def factor_filled(floats, ints):
    """`factor` where J T is written, with EASE of its diagonal added."""
    part = floats[ints[EASE_AT]]
    least = factor_with(floats, ints, part)
    if least > 0.0 or part > 0.0:
        return least
    fill(floats, ints, LITTLE)
    return factor_with(floats, ints, LITTLE)


@lean_inlined
def factor(floats, ints):
    """Factor J T; the least part of its diagonal that a pivot is, 0 where it cannot be factored.

    Where rows depend on others EASE of the diagonal is added, and LITTLE where they have only come to do so.
    """
    fill(floats, ints, floats[ints[EASE_AT]])
    return factor_filled(floats, ints)


@lean(types.void(A, I, types.boolean))
def solve_from(floats, ints, begun):
    """Solve with the factors, in place; ``begun``: for the right hand side that there was when they were made."""
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    if ints[FACTORS] == 0:
        solve_dense(floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]], ints[ROWS], stride(ints), right)
        return
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    solve_sparse(plan, factors, right, work, begun)


@lean_inlined
def solve(floats, ints):
    """Solve with the factors, in place."""
    solve_from(floats, ints, False)
