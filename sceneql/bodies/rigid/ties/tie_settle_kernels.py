# mypy: ignore-errors
"""Ties closed after a step, in place and in speed, each by the least change in energy."""

from numba import types

from sceneql.bodies.rigid.ties.tie_kernels import FAINT, MOST_CORRECTIONS, SHARE, balance, clear, refine, survey
from sceneql.bodies.rigid.ties.tie_layout import (
    EASE_AT,
    MOVED_AT,
    MOVERS,
    MOVERS_AT,
    ONE,
    OTHER,
    RIGHT_AT,
    ROWS,
    ROWS_AT,
    ROWS_FROM,
    ROWS_OF,
    SIDES,
    TIES,
    TIES_AT,
)
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_A,
    AT_C,
    AT_OPEN,
    AT_PUSHED,
    AT_SIZE,
    AT_SPEED,
    AT_TWIST,
    AT_V,
    AT_W,
    MOMENTUM,
    MOVED,
    MOVER,
    POSITION,
    ROTATION,
    ROW,
    ROW_INTS,
    SCRATCH,
    VELOCITY,
)  # fmt: skip
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, A, F, I, N

CLOSED = 1e-14
"""Gap of a row, against the numbers that it is the difference of, below which it is rounding."""
MOST_CLOSINGS = 6
SLIGHT = 1e-8
"""Such a gap up to which the factors of the ties' matrix before it is closed serve for the speeds after that."""
OPENED = 1e-6
"""Such a gap from which a tie counts as one that cannot be held."""


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


@lean_inlined
def speed_up(y, floats, ints, at, to):
    """Change the velocities of the mover of ints[at:] as floats[to + AT_A:] and what it was pushed say."""
    if ints[at + POSITION] >= 0:
        for c in range(3):
            y[ints[at + VELOCITY] + c] += floats[to + AT_A + c]
        if ints[at + ROTATION] >= 0:
            for c in range(3):
                y[ints[at + MOMENTUM] + c] += floats[to + AT_PUSHED + 3 + c]


@lean(F(A, I, N, N))
def weigh_speeds_of(floats, ints, tie, row):
    """`weigh_speeds` of a tie, from ``row`` of the right hand side on."""
    worst = 0.0
    which = ints[ints[TIES_AT] + SIDES * tie : ints[TIES_AT] + SIDES * (tie + 1)]
    first, second, to = ints[MOVED_AT] + MOVED * which[ONE], ints[MOVED_AT] + MOVED * which[OTHER], which[ROWS_FROM]
    one, two = floats[first : first + MOVED], floats[second : second + MOVED]
    for k in range(ints[RIGHT_AT] + row, ints[RIGHT_AT] + row + which[ROWS_OF]):
        own = floats[to : to + ROW]
        size = FAINT
        for c in range(3):
            size += abs(own[c] * one[AT_V + c]) + abs(own[3 + c] * one[AT_W + c])
            size += abs(own[6 + c] * two[AT_V + c]) + abs(own[9 + c] * two[AT_W + c])
        own[AT_SIZE], floats[k] = size, -own[AT_SPEED]
        if abs(own[AT_SPEED]) > worst * size:
            worst = abs(own[AT_SPEED]) / size
        to += ROW
    return worst


@lean(F(A, I))
def weigh_speeds(floats, ints):
    """Write the size of what the AT_SPEED of each row is a sum of to AT_SIZE, and less that speed to the right hand
    side; the largest speed against its size."""
    worst, row = 0.0, 0
    for tie in range(ints[TIES]):
        worst = max(worst, weigh_speeds_of(floats, ints, tie, row))
        row += ints[ints[TIES_AT] + SIDES * tie + ROWS_OF]
    return worst


@lean(AFTER_STEP, inner=True)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Closes the ties: places and rotations first, then velocities, each by the least change (in energy)."""
    changed, gap, before = False, 0.0, 1.0
    for _ in range(MOST_CLOSINGS):
        gap = survey(t1, y1, floats, ints)
        if gap <= CLOSED:
            break
        before = gap
        balance(floats, ints, AT_C, AT_SIZE)
        shift(y1, floats, ints)
        changed = True
    if t1 > t0 and gap > OPENED:
        for k in range(ints[ROWS]):
            to = ints[ints[ROWS_AT] + ROW_INTS * k + SCRATCH]
            if abs(floats[to + AT_C]) > OPENED * floats[to + AT_SIZE]:
                floats[to + AT_OPEN] = max(floats[to + AT_OPEN], abs(floats[to + AT_C]))
    speed = weigh_speeds(floats, ints)
    if speed > CLOSED:
        if gap > CLOSED:  # nothing was surveyed behind the last closing
            clear(floats, ints)
        # Where rows may depend on one another the matrix can change much by a slight motion.
        if before <= SLIGHT and gap <= CLOSED and floats[ints[EASE_AT]] == 0.0:
            # Nothing moves the movers yet: the speeds are what remains.
            refine(floats, ints, AT_SPEED, AT_SIZE, min(1.0, speed / SHARE), MOST_CORRECTIONS, False)
        else:
            balance(floats, ints, AT_SPEED, AT_SIZE)
        for m in range(ints[MOVERS]):
            speed_up(y1, floats, ints, ints[MOVERS_AT] + MOVER * m, ints[MOVED_AT] + MOVED * m)
        changed = True
    return changed
