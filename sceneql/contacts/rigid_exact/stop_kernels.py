# mypy: ignore-errors
"""Stops, motor and dry friction of a tie in exact contacts: a stop is a contact without a surface.

Its gap is what is left of the motion that the tie leaves. A motor is friction against a speed that it follows: at most
its largest force, against what the tie's speed is beyond that one.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_X, put
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.rigid_exact.contact_kernels import (
    BIAS,
    EXTENT,
    FIRST,
    GAP,
    KIND,
    NORMAL,
    OF,
    OWN_A,
    PAIR,
    POINT,
    RECORD,
    ROWS,
    SECOND,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    SLIDE,
    SPEED,
    TURN,
)
from sceneql.system.signatures_kernels import A, F, N

SURE = 1e-9
"""Slip at the start of a step [m/s, rad/s] for its end to be watched."""
STOP = 9
"""Kind of a contact, beside those of contact_kernels and curved_contact_kernels. SIGN: 1 at the least, -1 at the
greatest of the motion; OWN_A: where the floats of the tie's motion begin."""

FAR, FAST, DRIFT, LEAST, GREATEST, REBOUND, SIZE, FIRST_MOVER, SECOND_MOVER, ROW_AT, EFFORT_AT = range(11)
GIVEN_AT, TARGETS, TARGET_RATES, MOSTS, SIGNS, BROKEN, FORCES, SLIPS, DRIVEN = 11, 12, 14, 16, 18, 20, 22, 24, 26
"""Floats of the motion of a tie, of the state that was looked at: how far and how fast it has gone, its acceleration by
speeds alone; the stops (infinite: none) and their restitution; its size, that of the way between the stops (1: without
both); both movers by number, where in the floats its row begins (by speeds of both), where its effort is told
(behind that the energy that its motor gave), and where in y that energy is.
Of its motor, then of its friction: the speed that it is against, and how fast that changes; the largest force (0:
none). Kept of these: which way it slips (0: it does not); whether it has begun to within the step; the force; how fast
it slipped."""


@lean(types.void(A, N, N))
def follow_stop(floats, at, a):
    """Write what a contact with a stop is now, whose first mover's floats begin at a."""
    own, sign = int(floats[at + OWN_A]), floats[at + SIGN]
    far = floats[own + FAR] - floats[own + (LEAST if sign > 0.0 else GREATEST)]
    floats[at + GAP], floats[at + SPEED], floats[at + BIAS] = (
        sign * far,
        sign * floats[own + FAST],
        sign * floats[own + DRIFT],
    )
    row = int(floats[own + ROW_AT])
    for c in range(12):
        floats[at + ROWS + c] = sign * floats[row + c]
    put(floats, at + NORMAL, 0.0, 0.0, 0.0)
    put(floats, at + SLIDE, 0.0, 0.0, 0.0)
    put(floats, at + TURN, 0.0, 0.0, 0.0)
    put(floats, at + FIRST, 0.0, 0.0, 0.0)
    put(floats, at + SECOND, 0.0, 0.0, 0.0)
    # (An arm of 1, by which speeds of turning count among those that a speed is a sum of.)
    put(floats, at + POINT, floats[a + AT_X] + 1.0, floats[a + AT_X + 1], floats[a + AT_X + 2])


@lean(types.void(A, N, N, N, N, F, N, N))
def write_stop(floats, rec, own, first, second, sign, spot, a):
    """Write the contact with a stop of the motion whose floats begin at ``own``; its movers by number; ``a``: where the
    floats of the first begin."""
    for c in range(RECORD):
        floats[rec + c] = 0.0
    floats[rec + KIND], floats[rec + SIGN], floats[rec + PAIR], floats[rec + OWN_A] = STOP, sign, spot, own
    floats[rec + SHAPE_A], floats[rec + SHAPE_B], floats[rec + OF], floats[rec + EXTENT] = first, second, -1.0, math.inf
    follow_stop(floats, rec, a)


@lean_inlined
def slip(floats, own, j):
    """How fast the motion goes against what its motor (j 0) or its friction (1) follows."""
    return floats[own + FAST] - floats[own + TARGETS + j]


@lean_inlined
def stuck(floats, own, j):
    """Slip up to which it does not slip: none that is not watched, as its end would be missed."""
    return SURE * (1.0 + abs(floats[own + FAST]) + abs(floats[own + TARGETS + j]))


@lean(types.boolean(A, N))
def begin_slips(floats, own):
    """Keep which way a motor and friction slip now; whether that is as before."""
    same = True
    for j in range(2):
        now = slip(floats, own, j)
        way = 0.0 if abs(now) <= stuck(floats, own, j) else math.copysign(1.0, now)
        same = same and way == floats[own + SIGNS + j]
        floats[own + SIGNS + j], floats[own + SLIPS + j], floats[own + BROKEN + j] = way, abs(now), 0.0
    return same
