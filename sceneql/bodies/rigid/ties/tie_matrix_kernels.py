# mypy: ignore-errors
"""The matrix J T of all ties of an island: its layout, its values and its factors.

J are the rows of ties and T = J^T / M, with M the masses: it is positive semidefinite, sparse by the bodies that rows
share.
"""

import numpy as np
from numba import types

from sceneql.bodies.rigid.ties.tie_layout import (
    BEFORE,
    CHAIN_AT,
    DEPENDENT_AT,
    DIAGONAL_AT,
    EASE_AT,
    ENDED_AT,
    FACTORS,
    FACTORS_AT,
    HALF,
    LANES,
    LAST,
    MARKS,
    MOST_AT,
    MOVED_AT,
    OF_SHARED,
    OF_TIE,
    PLAN,
    PLAN_AT,
    RIGHT_AT,
    ROWS,
    SHARED_AT,
    SHARED_MOVER,
    SHARERS,
    SIDES,
    TIES,
    TIES_AT,
    VALUES,
    VALUES_AT,
    WORK,
    WORK_AT,
)
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_MASS, MOVED, ROW
from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import fma, load, store
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal import layout
from sceneql.system.signatures_kernels import A, F, I, N

# Compiled at the first system of many rows, of few, or of chains.
SPARSE = "sceneql.linear.multifrontal.factor_solve_kernels"
factor_sparse = lazy(f"{SPARSE}:factor_up", F(I, A, A, A, A, A))
solve_sparse = lazy(f"{SPARSE}:solve_after", types.void(I, A, A, A, types.boolean))
factor_dense = lazy("sceneql.linear.dense_symmetric_kernels:factor", F(A, N, N, F))
solve_dense = lazy("sceneql.linear.dense_symmetric_kernels:solve", types.void(A, N, N, A))
CHAIN = "sceneql.bodies.rigid.ties.tie_chain_kernels"
eliminate = lazy(f"{CHAIN}:eliminate", types.void(A, I, N, F))
solve_chain = lazy(f"{CHAIN}:solve", types.void(A, I, types.boolean))

T_OF = 48
"""Numbers of T of a tie, in columns of LANES, of which those behind its rows are 0."""
UPPER = np.triu(np.ones((LANES, LANES))).ravel()
"""Of a block's rows: 0 below the diagonal."""
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
def begin_matrix(floats, ints, part):
    """Zero J T where it is whole; where the first mover stands that ties share, of chains 0."""
    if ints[CHAIN_AT] >= 0:
        floats[ints[CHAIN_AT] + MOST_AT] = 1.0
        floats[ints[CHAIN_AT] + DEPENDENT_AT] = DEPENDENT if part == 0.0 else 0.0
        return 0
    if ints[FACTORS] == 0:
        values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
        for k in range(values.size):
            values[k] = 0.0
    return ints[SHARED_AT]


@lean_inlined
def add_tie(floats, ints, tie, at, part):
    """Write of J T what the rows of a tie make known; ``at`` and what it returns: as `add_mover`.

    Of chains the tie before is eliminated, of which lanes of numbers have reached the cache.
    """
    if ints[CHAIN_AT] >= 0:
        if tie > 0:
            eliminate(floats, ints, tie - 1, part)
        return 0
    marks = ints[ints[TIES_AT] + SIDES * tie + MARKS]
    if marks & LAST:
        at = add_mover(floats, ints, at, part)
    if marks & (2 * LAST):
        at = add_mover(floats, ints, at, part)
    return at


@lean_inlined
def end_matrix(floats, ints, part):
    """Add the last of the movers to J T, and end the diagonal where it is whole; eliminate the last tie of chains."""
    if ints[CHAIN_AT] >= 0:
        eliminate(floats, ints, ints[TIES] - 1, part)
        return
    if ints[ENDED_AT] >= 0:
        add_blocks(floats, ints, ints[ENDED_AT], part)
    if ints[FACTORS] == 0:
        values, along = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]], stride(ints)
        diagonal = floats[ints[DIAGONAL_AT] : ints[DIAGONAL_AT] + ints[ROWS]]
        end_diagonal(values, 0, along, diagonal, part)


@lean(types.void(A, I, F))
def fill(floats, ints, part):
    """Write J T, at least the half of it that is read, with a part of its diagonal added."""
    at = begin_matrix(floats, ints, part)
    for tie in range(ints[TIES]):
        at = add_tie(floats, ints, tie, at, part)
    end_matrix(floats, ints, part)


@lean(F(A, I, F))
def factor_with(floats, ints, part):
    """Factor J T, with a part of its diagonal added; the least part of it that a pivot is, at most what is added.

    0 where the matrix cannot be factored, or, without what is added, where rows depend. If the matrix is not whole, the
    first half of `solve` is done, too.
    """
    if ints[CHAIN_AT] >= 0:
        least = 1.0 / floats[ints[CHAIN_AT] + MOST_AT]
        return least if part == 0.0 else min(least, part)
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
    if ints[CHAIN_AT] >= 0:
        solve_chain(floats, ints, begun)
        return
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
