# mypy: ignore-errors
"""The forces of all ties of an island at once, and what takes their errors away.

With a' the accelerations by all other forces, M the masses and J the rows of ties, the accelerations are a' + T f, T =
J^T / M, with J (a' + T f) + bias = 0. The matrix J T is positive semidefinite, sparse by the bodies that rows share. It
is factored with a little of its diagonal added, and the solution is corrected by what it leaves: so ties that say the
same twice, or do so at one instant, share the force of least square (a proximal iteration: Rockafellar 1976).
"""

import math

from numba import types

from sceneql.bodies.rigid.tie_matrix_kernels import (
    MOVED_AT,
    MOVERS,
    MOVERS_AT,
    RIGHT_AT,
    ROWS,
    ROWS_AT,
    factor,
    solve,
)
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
    see,
    turning,
    weighed_by,
    write_row,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, F, I, N

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
