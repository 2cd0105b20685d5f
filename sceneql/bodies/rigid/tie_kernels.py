# mypy: ignore-errors
"""The forces of all ties of an island at once, and what takes their errors away.

With a' the accelerations by all other forces, M the masses and J the rows of ties, the accelerations are a' + T f, T =
J^T / M, with J (a' + T f) + bias = 0. The matrix J T is positive semidefinite, sparse by the bodies that rows share. It
is factored with a little of its diagonal added, and the solution is corrected by what it leaves: so ties that say the
same twice, or do so at one instant, share the force of least square (a proximal iteration: Rockafellar 1976).
"""

import math

from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import (
    AT_A,
    AT_BIAS,
    AT_C,
    AT_FORCE,
    AT_IMPULSE,
    AT_J,
    AT_MASS,
    AT_OPEN,
    AT_PUSHED,
    AT_SIZE,
    AT_SPEED,
    AT_TWIST,
    AT_V,
    AT_W,
    FIRST,
    MOMENTUM,
    MOVED,
    MOVER,
    POSITION,
    ROTATION,
    ROW,
    ROW_INTS,
    SCRATCH,
    SECOND,
    VELOCITY,
    press,
    put,
    see,
    turning,
    weighed_by,
    write_row,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal import layout
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, F, I, N

# Compiled at the first system of many rows, or of few.
factor_sparse = lazy("sceneql.linear.multifrontal.symmetric_kernels:factor_symmetric", types.boolean(I, A, A, A))
solve_sparse = lazy("sceneql.linear.multifrontal.solve_kernels:solve_symmetric", types.void(I, A, A, A))
factor_dense = lazy("sceneql.linear.dense_symmetric_kernels:factor", types.boolean(A, N, F))
solve_dense = lazy("sceneql.linear.dense_symmetric_kernels:solve", types.void(A, N, A))

MOVERS, ROWS, MOVERS_AT, ROWS_AT, SHARED, SHARED_AT, STARTS_AT, DIAGONAL_AT, PLAN_AT, PLAN = range(10)
MOVED_AT, VALUES_AT, VALUES, FACTORS_AT, FACTORS, WORK_AT, WORK, RIGHT_AT, KEPT_AT, EASE_AT, TIE_AT, HEAD = range(10, 22)
"""Integers of an island's ties: numbers of movers, rows, movers that ties share, of the plan's integers, and where each
begins; the first values of the matrix's rows, and the places of its diagonal's; offsets into the floats and sizes of
what movers, matrix, factors, scratch and right hand side take, and what drifts keep (rattle_kernels). Few rows have a
matrix that is whole, its factors in place, and no plan. A mover that ties share: their number n and its own; of each
tie OF_TIE: its first row, how many it has, their floats at its side, and how many rows at its beginning are those of a
BALL where all others leave the places alone (-1: others do not); then n x n places in a row of the first where the rows
of the second begin, counted from that row's first value (-1: what stands there is not read)."""
OF_TIE = 4
MOST_ROWS = 6
"""Most rows of a tie."""

KEPT = 12
"""Floats of a row that drifts keep of where they began: J."""
EASE, LITTLE, DEPENDENT = 1e-9, 1e-13, 1e-12
"""Part of the diagonal that is added to it, at floats[ints[EASE_AT]]: none where no row follows from others at the
start, so that light bodies may hold heavy ones, but LITTLE where a pivot is not above that part of its diagonal."""
COARSE = 1e-10
"""Part of an acceleration that sums of large forces may round off."""
LEFT, LONG = 1e-13, 1000
"""What may be left of an equation, against the numbers that it is a sum of; rows beyond which it is in proportion to
their number, as the rounding of the factors is."""
SHARE = 1e-2
"""Part of LEFT that may be left of the numbers that a gap is the difference of."""
FEW, MOST_CORRECTIONS = 6, 50
GAIN = 0.98
"""After FEW corrections one that leaves more than this part is the last: the rest is of ties that cannot hold."""
CLOSED = 1e-14
"""Gap of a row, against the numbers that it is the difference of, below which it is rounding."""
MOST_CLOSINGS = 6
OPENED = 1e-6
"""Such a gap from which a tie counts as one that cannot be held."""


@lean(types.void(F, A, A, I))
def survey(t, y, floats, ints):
    """Write the movers and the rows for a state."""
    for m in range(ints[MOVERS]):
        see(y, floats, ints[MOVED_AT] + MOVED * m, ints, ints[MOVERS_AT] + MOVER * m)
    for k in range(ints[ROWS]):
        row = ints[ROWS_AT] + ROW_INTS * k
        a, b = ints[MOVED_AT] + MOVED * ints[row + FIRST], ints[MOVED_AT] + MOVED * ints[row + SECOND]
        write_row(floats, ints, row, a, b)


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


@lean_inlined
def movers_of(ints, k):
    """Where the floats of row k begin, and those of its two movers."""
    row = ints[ROWS_AT] + ROW_INTS * k
    which = ints[row : row + ROW_INTS]
    at = ints[MOVED_AT]
    return which[SCRATCH], at + MOVED * which[FIRST], at + MOVED * which[SECOND]


@lean(types.void(A, I, N, N))
def balance(floats, ints, target, size_at):
    """Forces of the rows, to AT_FORCE, by which J x + floats[target] = 0 for x the movers' AT_A, which they change.

    floats[size_at] is the size of the numbers that the target is a sum of, if it is to be 0 but for their rounding.
    """
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    last, found = math.inf, False
    little = LEFT * max(1.0, ints[ROWS] / LONG)
    for m in range(ints[MOVERS]):
        mover = floats[ints[MOVED_AT] + MOVED * m : ints[MOVED_AT] + MOVED * (m + 1)]
        for c in range(6):
            mover[AT_PUSHED + c] = 0.0
    for corrections in range(MOST_CORRECTIONS if factor(floats, ints) else 0):
        worst = 0.0
        for k in range(ints[ROWS]):
            to, first, second = movers_of(ints, k)
            own = floats[to : to + ROW]
            one, two = floats[first + AT_A : first + AT_A + 6], floats[second + AT_A : second + AT_A + 6]
            left, size = floats[to + target], max(abs(floats[to + target]), SHARE * floats[to + size_at])
            other, sizes = 0.0, 0.0
            for c in range(6):
                part, parts = own[AT_J + c] * one[c], own[AT_J + 6 + c] * two[c]
                left, other = left + part, other + parts
                size, sizes = size + abs(part), sizes + abs(parts)
            left, size = left + other, size + sizes
            right[k] = -left
            if abs(left) > worst * size:
                worst = abs(left) / size
        if worst <= little or (corrections >= FEW and worst > GAIN * last):
            break
        last = worst
        solve(floats, ints)
        for m in range(ints[MOVERS]):
            mover = floats[ints[MOVED_AT] + MOVED * m : ints[MOVED_AT] + MOVED * (m + 1)]
            for c in range(6):
                mover[AT_IMPULSE + c] = 0.0
        for k in range(ints[ROWS]):
            to, first, second = movers_of(ints, k)
            own, force = floats[to : to + ROW], right[k]
            one, two = floats[first + AT_IMPULSE : first + AT_PUSHED], floats[second + AT_IMPULSE : second + AT_PUSHED]
            own[AT_FORCE] = own[AT_FORCE] + force if found else force
            for c in range(6):
                one[c] += own[AT_J + c] * force
                two[c] += own[AT_J + 6 + c] * force
        for m in range(ints[MOVERS]):
            mover = floats[ints[MOVED_AT] + MOVED * m : ints[MOVED_AT] + MOVED * (m + 1)]
            push = weighed_by(mover, mover[AT_IMPULSE:])
            for c in range(6):
                mover[AT_A + c] += push[c]
                mover[AT_PUSHED + c] += mover[AT_IMPULSE + c]
        found = True
    if not found:
        for k in range(ints[ROWS]):
            floats[ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH] + AT_FORCE] = 0.0


@lean(types.void(A, A, I))
def add(rate, floats, ints):
    """Adds the rows' forces and torques to the entries of velocities and angular momenta."""
    for m in range(ints[MOVERS]):
        at, pushed = ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m + AT_PUSHED
        if ints[at + POSITION] >= 0:
            for c in range(3):
                rate[ints[at + VELOCITY] + c] += floats[pushed + c]
            if ints[at + ROTATION] >= 0:
                for c in range(3):
                    rate[ints[at + MOMENTUM] + c] += floats[pushed + 3 + c]


@lean_inlined
def unlike(a, b, c, x, y, z):
    """Whether a vector differs from another by more than rounding would do."""
    apart, size = max(abs(a - x), abs(b - y), abs(c - z)), max(abs(x), abs(y), abs(z))
    return apart > COARSE * size


@lean(types.void(A, A, A, I))
def sharpen(y, rate, floats, ints):
    """Take the accelerations themselves where the forces of ties on a light body are so large that sums round them."""
    for m in range(ints[MOVERS]):
        at, to = ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m
        inverse = floats[to + AT_MASS]
        if ints[at + POSITION] < 0 or inverse == 0.0:
            continue
        v, x, y_, z = ints[at + VELOCITY], floats[to + AT_A], floats[to + AT_A + 1], floats[to + AT_A + 2]
        if unlike(inverse * rate[v], inverse * rate[v + 1], inverse * rate[v + 2], x, y_, z):
            rate[v], rate[v + 1], rate[v + 2] = x / inverse, y_ / inverse, z / inverse
        if ints[at + ROTATION] >= 0:
            k = ints[at + MOMENTUM]
            x, y_, z = turning(y, floats, to, k)
            if unlike(rate[k], rate[k + 1], rate[k + 2], x, y_, z):
                rate[k], rate[k + 1], rate[k + 2] = x, y_, z


@lean(TERM, inner=True)
def hold(t, y, rate, floats, ints):
    """Adds the forces [N] and torques [N m] of all ties."""
    survey(t, y, floats, ints)
    for m in range(ints[MOVERS]):
        press(y, rate, floats, ints[MOVED_AT] + MOVED * m, ints, ints[MOVERS_AT] + MOVER * m)
    balance(floats, ints, AT_BIAS, AT_BIAS)
    add(rate, floats, ints)
    sharpen(y, rate, floats, ints)


@lean_inlined
def clear(floats, ints):
    """Zero the movers' accelerations."""
    for m in range(ints[MOVERS]):
        for c in range(6):
            floats[ints[MOVED_AT] + MOVED * m + AT_A + c] = 0.0


@lean_inlined
def open_by(floats, ints, at):
    """The largest gap of a row, against the numbers that it is the difference of."""
    worst = 0.0
    for k in range(ints[ROWS]):
        to = ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH]
        worst = max(worst, abs(floats[to + at]) / max(floats[to + AT_SIZE], 1e-300))
    return worst


@lean(types.void(A, A, I, N, N))
def shift_mover(y, floats, ints, at, to):
    """Move the body of the mover of ints[at:] by the change of place and rotation at floats[to + AT_A:]."""
    x, q = ints[at + POSITION], ints[at + ROTATION]
    if x < 0:
        return
    for c in range(3):
        y[x + c] += floats[to + AT_A + c]
    if q >= 0:
        ux, uy, uz = 0.5 * floats[to + AT_TWIST], 0.5 * floats[to + AT_TWIST + 1], 0.5 * floats[to + AT_TWIST + 2]
        a, b, c, d = y[q], y[q + 1], y[q + 2], y[q + 3]
        # q + (0, u) q, of the same length.
        e, f = a - (ux * b + uy * c + uz * d), b + ux * a + uy * d - uz * c
        g, h = c + uy * a + uz * b - ux * d, d + uz * a + ux * c - uy * b
        scale = ((a * a + b * b + c * c + d * d) / (e * e + f * f + g * g + h * h)) ** 0.5
        y[q], y[q + 1], y[q + 2], y[q + 3] = e * scale, f * scale, g * scale, h * scale


@lean(types.void(A, A, I))
def shift(y, floats, ints):
    """Move the bodies by the movers' changes of place and rotation."""
    for m in range(ints[MOVERS]):
        shift_mover(y, floats, ints, ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m)


@lean(AFTER_STEP, inner=True)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Closes the ties: places and rotations first, then velocities, each by the least change (in energy)."""
    changed, gap = False, 0.0
    for _ in range(MOST_CLOSINGS):
        survey(t1, y1, floats, ints)
        gap = open_by(floats, ints, AT_C)
        if gap <= CLOSED:
            break
        clear(floats, ints)
        balance(floats, ints, AT_C, AT_SIZE)
        shift(y1, floats, ints)
        changed = True
    if t1 > t0 and gap > OPENED:
        for k in range(ints[ROWS]):
            to = ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH]
            if abs(floats[to + AT_C]) > OPENED * floats[to + AT_SIZE]:
                floats[to + AT_OPEN] = max(floats[to + AT_OPEN], abs(floats[to + AT_C]))
    worst = 0.0
    for k in range(ints[ROWS]):
        row = ints[ROWS_AT] + ROW_INTS * k
        to = ints[row + SCRATCH]
        size = 0.0
        for side in range(2):
            mover = ints[MOVED_AT] + MOVED * ints[row + FIRST + side]
            for c in range(3):
                size += abs(floats[to + AT_J + 6 * side + c] * floats[mover + AT_V + c])
                size += abs(floats[to + AT_J + 6 * side + 3 + c] * floats[mover + AT_W + c])
        floats[to + AT_SIZE] = size
        if abs(floats[to + AT_SPEED]) > worst * size:
            worst = abs(floats[to + AT_SPEED]) / size
    if worst > CLOSED:
        clear(floats, ints)
        balance(floats, ints, AT_SPEED, AT_SIZE)
        for m in range(ints[MOVERS]):
            at = ints[MOVERS_AT] + MOVER * m
            mover = ints[MOVED_AT] + MOVED * m
            if ints[at + POSITION] >= 0:
                for c in range(3):
                    y1[ints[at + VELOCITY] + c] += floats[mover + AT_A + c]
                if ints[at + ROTATION] >= 0:
                    for c in range(3):
                        y1[ints[at + MOMENTUM] + c] += floats[mover + AT_PUSHED + 3 + c]
        changed = True
    return changed
