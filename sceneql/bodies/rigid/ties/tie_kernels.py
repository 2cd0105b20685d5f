# mypy: ignore-errors
"""The forces of all ties of an island at once, and what takes their errors away.

With a' the accelerations by all other forces, M the masses and J the rows of ties, the accelerations are a' + T f, T =
J^T / M, with J (a' + T f) + bias = 0. The matrix J T is positive semidefinite, sparse by the bodies that rows share. It
is factored with a little of its diagonal added, and the solution is corrected by what it leaves: so ties that say the
same twice, or do so at one instant, share the force of least square (a proximal iteration: Rockafellar 1976).
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_layout import (
    EASE_AT,
    FRESH,
    KIND_BITS,
    KINDS,
    LAST,
    MARKS,
    MOVED_AT,
    MOVERS,
    MOVERS_AT,
    NUMBERS_FROM,
    ONE,
    OTHER,
    RIGHT_AT,
    ROWS,
    ROWS_AT,
    ROWS_FROM,
    ROWS_OF,
    SIDES,
    STRIDE,
    TIE_HOLDS,
    TIES,
    TIES_AT,
)
from sceneql.bodies.rigid.ties.tie_matrix_kernels import add_tie, begin_matrix, end_matrix, factor_filled, solve_from
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_A,
    AT_BIAS,
    AT_C,
    AT_FORCE,
    AT_IMPULSE,
    AT_MASS,
    AT_PUSHED,
    AT_SIZE,
    MOMENTUM,
    MOVED,
    MOVER,
    POSITION,
    ROTATION,
    ROW,
    ROW_INTS,
    SCRATCH,
    VELOCITY,
    WRITTEN,
    press,
    see,
    turning,
    weighed_by,
    write,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.prefetch_kernels import fetch_all
from sceneql.system.signatures_kernels import TERM, A, F, I, N

COARSE = 1e-10
"""Part of an acceleration that sums of large forces may round off."""
LEFT, LONG = 1e-13, 1000
"""What may be left of an equation, against the numbers that it is a sum of; rows beyond which it is in proportion to
their number, as the rounding of the factors is."""
WELL, SHORT = 1e-7, 500
"""Part of its diagonal above which the least pivot of the factors leaves next to nothing to correct; rows of a chain up
to which that holds. The least pivot of a chain of n links is of the order of 1/n^3, however well it is solved."""
SHARE = 1e-2
"""Part of LEFT that may be left of the numbers that a gap is the difference of."""
FAINT = 1e-80
"""Least size of the numbers that an equation is a sum of: what is left of fainter ones no force takes away that counts
(tie_chain_kernels.NONE)."""
FEW, MOST_CORRECTIONS = 6, 50
GAIN = 0.98
"""After FEW corrections one that leaves more than this part is the last: the rest is of ties that cannot hold."""
AHEAD = 5
"""Ties that are fetched from memory before they are written."""


@lean_inlined
def fetch_tie(floats, ints, tie):
    """Ask for what is read and written of a tie that comes soon, and of movers that come with it first."""
    which = ints[ints[TIES_AT] + SIDES * tie : ints[TIES_AT] + SIDES * (tie + 1)]
    fetch_all(floats, which[ROWS_FROM], which[ROWS_FROM] + ROW * which[ROWS_OF])
    for side in range(2):
        if which[MARKS] & (FRESH << side):
            to = ints[MOVED_AT] + MOVED * which[ONE + side]
            fetch_all(floats, to, to + MOVED)


@lean(types.void(A, I, N))
def write_tie(floats, which, moved):
    """Write the rows of the tie of the integers ``which``, where the floats of movers begin at ``moved``."""
    one, two, holds = moved + MOVED * which[ONE], moved + MOVED * which[OTHER], floats[which[TIE_HOLDS]] != 0.0
    to, numbers, kinds = which[ROWS_FROM], which[NUMBERS_FROM], which[KINDS]
    for _ in range(which[ROWS_OF]):
        kind = kinds & ((1 << KIND_BITS) - 1)
        if kind != WRITTEN:
            write(floats, kind, to, numbers, holds, one, two)
            numbers += which[STRIDE]
        kinds >>= KIND_BITS
        to += ROW


@lean_inlined
def survey_tie(y, floats, ints, tie):
    """`survey` of a tie, after those before it."""
    worst, which = 0.0, ints[ints[TIES_AT] + SIDES * tie : ints[TIES_AT] + SIDES * (tie + 1)]
    for side in range(2):
        if which[MARKS] & (FRESH << side):
            m = which[ONE + side]
            see(y, floats, ints[MOVED_AT] + MOVED * m, ints, ints[MOVERS_AT] + MOVER * m)
    write_tie(floats, which, ints[MOVED_AT])
    to = which[ROWS_FROM]
    for _ in range(which[ROWS_OF]):
        gap, size = abs(floats[to + AT_C]), max(floats[to + AT_SIZE], 1e-300)
        if gap > worst * size:
            worst = gap / size
        to += ROW
    return worst


@lean(F(F, A, A, I))
def survey(t, y, floats, ints):
    """Write the movers, at no acceleration, and the rows for a state; the largest gap of a row, against the numbers
    that it is the difference of."""
    worst = 0.0
    for tie in range(ints[TIES]):
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        worst = max(worst, survey_tie(y, floats, ints, tie))
    return worst


@lean(F(A, I, N, N, N, N, A))
def left_of(floats, ints, tie, row, target, size_at, right):
    """Write -(J x + floats[target]) of a tie's rows; the largest, against the numbers that it is a sum of."""
    worst, which = 0.0, ints[ints[TIES_AT] + SIDES * tie : ints[TIES_AT] + SIDES * (tie + 1)]
    first, second = ints[MOVED_AT] + MOVED * which[ONE] + AT_A, ints[MOVED_AT] + MOVED * which[OTHER] + AT_A
    one, two = floats[first : first + 6], floats[second : second + 6]
    a, b, c, d, e, f = one[0], one[1], one[2], one[3], one[4], one[5]
    u, v, w, x, y, z = two[0], two[1], two[2], two[3], two[4], two[5]
    to = which[ROWS_FROM]
    for k in range(row, row + which[ROWS_OF]):
        own = floats[to : to + ROW]
        wanted = own[target]
        size = max(abs(wanted), SHARE * own[size_at], FAINT)
        a1, b1, c1, d1, e1, f1 = own[0] * a, own[1] * b, own[2] * c, own[3] * d, own[4] * e, own[5] * f
        u1, v1, w1, x1, y1, z1 = own[6] * u, own[7] * v, own[8] * w, own[9] * x, own[10] * y, own[11] * z
        left = wanted + ((a1 + b1 + c1) + (d1 + e1 + f1)) + ((u1 + v1 + w1) + (x1 + y1 + z1))
        size += (abs(a1) + abs(b1) + abs(c1)) + (abs(d1) + abs(e1) + abs(f1))
        size += (abs(u1) + abs(v1) + abs(w1)) + (abs(x1) + abs(y1) + abs(z1))
        right[k] = -left
        if abs(left) > worst * size:
            worst = abs(left) / size
        to += ROW
    return worst


@lean(F(A, I, N, N))
def remaining(floats, ints, target, size_at):
    """`left_of` all ties, to the right hand side."""
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    worst, row = 0.0, 0
    for tie in range(ints[TIES]):
        worst = max(worst, left_of(floats, ints, tie, row, target, size_at, right))
        row += ints[ints[TIES_AT] + SIDES * tie + ROWS_OF]
    return worst


@lean_inlined
def move_by(mover):
    """Add what ties push a mover, once all have, to its AT_A and to all that they do."""
    change = weighed_by(mover, mover[AT_IMPULSE:])
    for c in range(6):
        mover[AT_A + c] += change[c]
        mover[AT_PUSHED + c] += mover[AT_IMPULSE + c]
        mover[AT_IMPULSE + c] = 0.0


@lean(types.void(A, I, A, types.boolean), inner=True)
def push(floats, ints, right, further):
    """Add the rows' forces ``right`` to AT_FORCE (else write them), what they push to the movers, and to their AT_A."""
    row = 0
    for tie in range(ints[TIES]):
        which = ints[ints[TIES_AT] + SIDES * tie : ints[TIES_AT] + SIDES * (tie + 1)]
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        a = b = c = d = e = f = u = v = w = x = y = z = 0.0
        to = which[ROWS_FROM]
        for _ in range(which[ROWS_OF]):
            own, force = floats[to : to + ROW], right[row]
            own[AT_FORCE] = own[AT_FORCE] + force if further else force
            a, b, c = a + own[0] * force, b + own[1] * force, c + own[2] * force
            d, e, f = d + own[3] * force, e + own[4] * force, f + own[5] * force
            u, v, w = u + own[6] * force, v + own[7] * force, w + own[8] * force
            x, y, z = x + own[9] * force, y + own[10] * force, z + own[11] * force
            row += 1
            to += ROW
        first, second = ints[MOVED_AT] + MOVED * which[ONE], ints[MOVED_AT] + MOVED * which[OTHER]
        mover = floats[first : first + MOVED]
        one = mover[AT_IMPULSE : AT_IMPULSE + 6]
        one[0], one[1], one[2] = one[0] + a, one[1] + b, one[2] + c
        one[3], one[4], one[5] = one[3] + d, one[4] + e, one[5] + f
        if which[MARKS] & LAST:
            move_by(mover)
        mover = floats[second : second + MOVED]
        two = mover[AT_IMPULSE : AT_IMPULSE + 6]
        two[0], two[1], two[2] = two[0] + u, two[1] + v, two[2] + w
        two[3], two[4], two[5] = two[3] + x, two[4] + y, two[5] + z
        if which[MARKS] & (2 * LAST):
            move_by(mover)


@lean_inlined
def little_of(ints):
    """What may be left of an equation, against the numbers that it is a sum of."""
    return LEFT * max(1.0, ints[ROWS] / LONG)


@lean(types.void(A, I, N, N, F, N, types.boolean))
def refine(floats, ints, target, size_at, worst, most, begun):
    """The forces of `balance` by the factors that there are, in at most so many corrections.

    ``worst`` remains at first, as `remaining` left it on the right hand side; ``begun``: as for `solve_from`.
    """
    right = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]]
    last, found = math.inf, False
    little = little_of(ints)
    for corrections in range(most):
        if corrections > 0:
            worst = remaining(floats, ints, target, size_at)
        if worst <= little or (corrections >= FEW and worst > GAIN * last):
            break
        last = worst
        solve_from(floats, ints, begun and not found)
        push(floats, ints, right, found)
        found = True
    if not found:
        for k in range(ints[ROWS]):
            floats[ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH] + AT_FORCE] = 0.0


@lean_inlined
def well(ints, least):
    """Whether factors with a least pivot solve at once."""
    return least * max(1.0, ints[ROWS] / SHORT) ** 3 > WELL


@lean(types.void(A, I, N, N, F))
def correct(floats, ints, target, size_at, worst):
    """`balance` where the matrix, and on the right hand side what remains, ``worst`` at most, are written already."""
    least = factor_filled(floats, ints)
    sure = size_at != AT_SIZE and well(ints, least)
    most = 0 if least == 0.0 else 1 if sure else MOST_CORRECTIONS
    refine(floats, ints, target, size_at, worst, most, True)


@lean(types.void(A, I, N, N))
def balance(floats, ints, target, size_at):
    """Forces of the rows, to AT_FORCE, by which J x + floats[target] = 0 for x the movers' AT_A, which they change.

    What they do to the movers is added to AT_PUSHED. floats[size_at] is the size of the numbers that the target is a
    sum of, if it is to be 0 but for their rounding.
    """
    right, part = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]], floats[ints[EASE_AT]]
    worst, row, shared = 0.0, 0, begin_matrix(floats, ints, part)
    for tie in range(ints[TIES]):
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        worst = max(worst, left_of(floats, ints, tie, row, target, size_at, right))
        shared = add_tie(floats, ints, tie, shared, part)
        row += ints[ints[TIES_AT] + SIDES * tie + ROWS_OF]
    end_matrix(floats, ints, part)
    correct(floats, ints, target, size_at, worst)


@lean_inlined
def unlike(a, b, c, x, y, z):
    """Whether a vector differs from another by more than rounding would do."""
    apart, size = max(abs(a - x), abs(b - y), abs(c - z)), max(abs(x), abs(y), abs(z))
    return apart > COARSE * size


@lean_inlined
def add_to(y, rate, floats, at, to, ints):
    """`add` for the mover of ints[at:] and floats[to:]."""
    if ints[at + POSITION] < 0:
        return
    body = floats[to : to + MOVED]
    inverse, v = body[AT_MASS], ints[at + VELOCITY]
    force = rate[v : v + 3]
    for c in range(3):
        force[c] += body[AT_PUSHED + c]
    x, y_, z = body[AT_A], body[AT_A + 1], body[AT_A + 2]
    if inverse > 0.0 and unlike(inverse * force[0], inverse * force[1], inverse * force[2], x, y_, z):
        force[0], force[1], force[2] = x / inverse, y_ / inverse, z / inverse
    if ints[at + ROTATION] >= 0:
        k = ints[at + MOMENTUM]
        torque = rate[k : k + 3]
        for c in range(3):
            torque[c] += body[AT_PUSHED + 3 + c]
        x, y_, z = turning(y, floats, to, k)
        if inverse > 0.0 and unlike(torque[0], torque[1], torque[2], x, y_, z):
            torque[0], torque[1], torque[2] = x, y_, z


@lean(types.void(A, A, A, I))
def add(y, rate, floats, ints):
    """Adds the rows' forces and torques to the entries of velocities and angular momenta.

    Those of the accelerations themselves where the forces of ties on a light body are so large that sums round them.
    """
    for m in range(ints[MOVERS]):
        add_to(y, rate, floats, ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m, ints)


@lean(TERM, inner=True)
def hold(t, y, rate, floats, ints):
    """Adds the forces [N] and torques [N m] of all ties."""
    # As `survey` and `balance`, but with each mover and each row looked at once while it is in the cache.
    right, part = floats[ints[RIGHT_AT] : ints[RIGHT_AT] + ints[ROWS]], floats[ints[EASE_AT]]
    worst, row, shared = 0.0, 0, begin_matrix(floats, ints, part)
    for tie in range(ints[TIES]):
        which = ints[ints[TIES_AT] + SIDES * tie : ints[TIES_AT] + SIDES * (tie + 1)]
        if tie + AHEAD < ints[TIES]:
            fetch_tie(floats, ints, tie + AHEAD)
        for side in range(2):
            if which[MARKS] & (FRESH << side):
                m = which[ONE + side]
                to, at = ints[MOVED_AT] + MOVED * m, ints[MOVERS_AT] + MOVER * m
                see(y, floats, to, ints, at)
                press(y, rate, floats, to, ints, at)
        write_tie(floats, which, ints[MOVED_AT])
        worst = max(worst, left_of(floats, ints, tie, row, AT_BIAS, AT_BIAS, right))
        shared = add_tie(floats, ints, tie, shared, part)
        row += which[ROWS_OF]
    end_matrix(floats, ints, part)
    correct(floats, ints, AT_BIAS, AT_BIAS, worst)
    add(y, rate, floats, ints)


@lean_inlined
def clear(floats, ints):
    """Zero the movers' accelerations, and what ties push them."""
    for m in range(ints[MOVERS]):
        for c in range(AT_A, MOVED):
            floats[ints[MOVED_AT] + MOVED * m + c] = 0.0
