# mypy: ignore-errors
"""The matrix J T of all ties of an island: its layout, its values and its factors.

J are the rows of ties and T = J^T / M, with M the masses: it is positive semidefinite, sparse by the bodies that rows
share.
"""

from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import AT_J, MOVED, ROW, weighed_by
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal import layout
from sceneql.system.signatures_kernels import A, F, I, N

# Compiled at the first system of many rows, or of few.
factor_sparse = lazy("sceneql.linear.multifrontal.symmetric_kernels:factor_symmetric", types.boolean(I, A, A, A))
solve_sparse = lazy("sceneql.linear.multifrontal.solve_kernels:solve_symmetric", types.void(I, A, A, A))
factor_dense = lazy("sceneql.linear.dense_symmetric_kernels:factor", types.boolean(A, N, F))
solve_dense = lazy("sceneql.linear.dense_symmetric_kernels:solve", types.void(A, N, A))

MOVERS, ROWS, MOVERS_AT, ROWS_AT, SHARED, SHARED_AT, STARTS_AT, DIAGONAL_AT, PLAN_AT, PLAN = range(10)
MOVED_AT, VALUES_AT, VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, KEPT_AT, EASE_AT, TIE_AT, HEAD = range(
    10, 22
)
"""Integers of an island's ties: numbers of movers, rows, movers that ties share, of the plan's integers, and where each
begins; the first values of the matrix's rows, and the places of its diagonal's; offsets into the floats and sizes of
what movers, matrix, factors, scratch and right hand side take, and what drifts keep (rattle_kernels); of EASE; of T of
a tie. Few rows have a matrix that is whole, its factors in place, and no plan. A mover that ties share: their number n
and its own; of each tie OF_TIE: its first row, how many it has, their floats at its side, and how many rows at its
beginning are those of a BALL where all others leave the places alone (-1: others do not); then n x n places in a row of
the first where the rows of the second begin, counted from that row's first value (-1: what stands there is not
read)."""
OF_TIE = 4
MOST_ROWS = 6
"""Most rows of a tie."""
KEPT = 12
"""Floats of a row that drifts keep of where they began: J."""
EASE, LITTLE, DEPENDENT = 1e-9, 1e-13, 1e-12
"""Part of the diagonal that is added to it, at floats[ints[EASE_AT]]: none where no row follows from others at the
start, so that light bodies may hold heavy ones, but LITTLE where a pivot is not above that part of its diagonal."""


@lean_inlined
def add_block(values, begins, place, upright, floats, to, t, others, units, same):
    """Add J of a tie, at floats[to:] and behind, times T of another to their block, or to that turned over.

    ``place``: of its values in the rows that begin at ``begins``; ``others``: how many rows the other tie has;
    ``units``: rows of both that alone know places (-1: any); of one with the ``same`` the half.
    """
    columns = others if upright else begins.size
    for j in range(columns):
        here = t[6 * j : 6 * j + 6]
        x, y, z, u, v, w = here[0], here[1], here[2], here[3], here[4], here[5]
        rows = begins.size if upright else others
        if same:
            rows = j + 1 if upright else j
        for i in range(rows):
            six = floats[to + ROW * i : to + ROW * i + 6]
            total = six[3] * u + six[4] * v + six[5] * w
            if units < 0 or (i < units and j < units):
                total += six[0] * x + six[1] * y + six[2] * z
            if upright:
                values[begins[i] + place + j] += total
            else:
                values[begins[j] + place + i] += total


@lean(types.void(A, I))
def fill(floats, ints):
    """Write J T, at least the half of it that is read."""
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    for k in range(values.size):
        values[k] = 0.0
    at, starts = ints[SHARED_AT], ints[STARTS_AT]
    # T is kept of one tie alone: the rows of a long chain do not fit into the caches, and memory is what bounds it.
    t = floats[ints[TIE_AT] : ints[TIE_AT] + 6 * MOST_ROWS]
    # Of a tie's own block the other half is read where its rows are eliminated in any order.
    mixed = ints[FACTORS] > 0 and ints[ints[PLAN_AT] + layout.UNIT] == 1
    for _ in range(ints[SHARED]):
        count, mover = ints[at], ints[MOVED_AT] + MOVED * ints[at + 1]
        table = at + 2 + OF_TIE * count
        m = floats[mover : mover + MOVED]
        for other in range(count):
            which = ints[at + 2 + OF_TIE * other : at + 2 + OF_TIE * (other + 1)]
            last, columns, own, known = which[0], which[1], which[2] + AT_J, which[3]
            for j in range(columns):
                push, here = weighed_by(m, floats[own + ROW * j : own + ROW * j + 6]), t[6 * j : 6 * j + 6]
                for c in range(6):
                    here[c] = push[c]
            for one in range(other + 1):
                which = ints[at + 2 + OF_TIE * one : at + 2 + OF_TIE * (one + 1)]
                first, rows, to, units = which[0], which[1], which[2] + AT_J, which[3]
                across, along = ints[table + count * one + other], ints[table + count * other + one]
                units = min(units, known) if units >= 0 and known >= 0 else -1
                if across >= 0:
                    begins = ints[starts + first : starts + first + rows]
                    add_block(values, begins, across, True, floats, to, t, columns, units, one == other)
                if along >= 0 and (one != other or mixed):
                    begins = ints[starts + last : starts + last + columns]
                    add_block(values, begins, along, False, floats, to, t, rows, units, one == other)
        at = table + count * count


@lean_inlined
def depends(values, factors, ints, plan):
    """Whether a pivot of sparse factors is not above the part DEPENDENT of its diagonal."""
    for s in range(plan[1]):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height, panel = plan[t], plan[t + 1], plan[t + 2], plan[t + 5]
        for k in range(width):
            diagonal = values[ints[ints[DIAGONAL_AT] + plan[plan[2] + first + k]]]
            inverse = factors[panel + k * (height + 1)]
            if not 0.0 < inverse < 1.0 / (DEPENDENT * diagonal):
                return True
    return False


@lean(types.boolean(A, I, F))
def factor_with(floats, ints, part):
    """Factor J T with a part of its diagonal added; False where that cannot be, or without it where rows depend."""
    fill(floats, ints)
    values = floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]]
    for k in range(ints[ROWS]):
        place = ints[ints[DIAGONAL_AT] + k]
        # A row that no mass can meet, as of two parts that are led, has no force.
        values[place] = values[place] * (1.0 + part) if values[place] > 0.0 else 1.0
    if ints[FACTORS] == 0:
        return factor_dense(values, ints[ROWS], DEPENDENT if part == 0.0 else 0.0)
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    return factor_sparse(plan, values, factors, work) and (part > 0.0 or not depends(values, factors, ints, plan))


@lean(types.boolean(A, I))
def factor(floats, ints):
    """Factor J T; False where that cannot be.

    Where rows depend on others EASE of the diagonal is added, and LITTLE where they have only come to do so.
    """
    part = floats[ints[EASE_AT]]
    return factor_with(floats, ints, part) or (part == 0.0 and factor_with(floats, ints, LITTLE))


@lean(types.void(A, I))
def solve(floats, ints):
    """Solve with the factors, in place."""
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    if ints[FACTORS] == 0:
        solve_dense(floats[ints[VALUES_AT] : ints[VALUES_AT] + ints[VALUES]], ints[ROWS], right)
        return
    plan = ints[ints[PLAN_AT] : ints[PLAN_AT] + ints[PLAN]]
    factors = floats[ints[FACTORS_AT] : ints[FACTORS_AT] + ints[FACTORS]]
    work = floats[ints[WORK_AT] : ints[WORK_AT] + ints[WORK]]
    solve_sparse(plan, factors, right, work)
