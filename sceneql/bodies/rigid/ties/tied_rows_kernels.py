# mypy: ignore-errors
"""Ties in a step of velocities as rows of the cone program: ties, stops, motors and friction.

Groups of bodies that ties hold
together step in one of four ways:

    AWAY     the solver's own step, where they neither touch anything nor have a motor or friction
    STEADY   that step and half of what the impulses change it by: motors and friction alone, the same all the step
    PRESSED  the velocities at the end of the step, from its start, as all that touches (Moreau 1988)
    STRUCK   the solver's own step, which has been cut where it hits a stop, and the impulses at its end
"""

import math

from numba import types

from sceneql.bodies.rigid.drive_kernels import (
    ANGLE,
    DRIVE_INTS,
    EFFORT_AT,
    FRICTION_AT,
    LIMITS_AT,
    MOST_AT,
    MOTOR,
    NO_MOTOR,
    REACHED_AT,
    REBOUND_AT,
    ROW_AT,
    SETTLING_AT,
    TARGET_AT,
    motion,
)
from sceneql.bodies.rigid.moved_bodies_kernels import (
    ACTIVE_AT,
    AWAY,
    BODY_GROUPS_AT,
    DRIVES,
    DRIVES_AT,
    GROUPS,
    GROUPS_AT,
    PRESSED,
    SIDES_AT,
    STEADY,
    STRUCK,
    TIES,
    TIES_AT,
)
from sceneql.bodies.rigid.ties.tie_kernels import survey
from sceneql.bodies.rigid.ties.tie_layout import MOVED_AT, MOVERS_AT, ROWS_AT
from sceneql.bodies.rigid.ties.tie_layout import ROWS as TIE_ROWS
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_C,
    AT_J,
    AT_SPEED,
    AT_V,
    AT_W,
    FIRST,
    HOLDS,
    MOVED,
    MOVER,
    POSITION,
    ROW_INTS,
    SCRATCH,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.cones.cone_layout_kernels import ROW, ROW_GIVEN, ROW_HIGH, ROW_J, ROW_LOW, ROW_X
from sceneql.system.signatures_kernels import A, F, I, N

GROUP, FLIPPED, SIDE_INTS = range(3)
"""Integers of a row: its group, and whether the first of its two bodies is the tie's second."""

DRIVE_GROUP, DRIVE_FLIPPED, DRIVE = range(DRIVE_INTS, DRIVE_INTS + 3)
"""Integers of a drive, behind those of drive_kernels: as of a row."""

BOUNCES = 2.0
"""A part bounces off a stop that approaches faster than the step's forces make it in so many steps."""
AT_STOP = 1e-2
"""Part of a step's way within which the end of a step that was cut is at the stop."""


@lean_inlined
def drive_of(own, k):
    """Where the integers of a drive begin."""
    return own[DRIVES_AT] + DRIVE * k


@lean_inlined
def fast(early, late):
    """Whether a part that approaches a stop, at the start and at the end of a step, bounces."""
    return early < 0.0 and late < 0.0 and -early > BOUNCES * abs(late - early)


@lean(types.void(F, A, A, A, I))
def begin_ties(h, y0, y1, floats, own):
    """How groups step, whatever touches: those that pass a stop or are at one, those with motors or friction."""
    for g in range(own[GROUPS]):
        floats[own[ACTIVE_AT] + g] = STEADY if own[own[GROUPS_AT] + g] > 0 else AWAY
    for k in range(own[DRIVES]):
        drive = own[drive_of(own, k) : drive_of(own, k) + DRIVE]
        floats[drive[EFFORT_AT]] = 0.0
        if drive[LIMITS_AT] < 0 or floats[drive[ROW_AT + HOLDS]] == 0.0:
            continue
        end, late = motion(y1, floats, drive)
        _, early = motion(y0, floats, drive)
        at = own[ACTIVE_AT] + drive[DRIVE_GROUP]
        for j in range(2):
            way = 1.0 if j == 0 else -1.0
            gap = way * (end - floats[drive[LIMITS_AT] + j])
            if abs(gap) <= AT_STOP * h * abs(late) and fast(way * early, way * late) and floats[at] == AWAY:
                floats[at] = STRUCK
            elif gap < 0.0 and floats[at] == AWAY:
                floats[at] = PRESSED


@lean(types.float64(F, A, A, A, I))
def first_stop(h, y0, y1, floats, own):
    """Part of the step after which a part first hits a stop, 1 for none: by a cubic curve (Hermite's) along it."""
    first = 1.0
    for k in range(own[DRIVES]):
        drive = own[drive_of(own, k) : drive_of(own, k) + DRIVE]
        if drive[LIMITS_AT] < 0 or floats[drive[ROW_AT + HOLDS]] == 0.0 or own[own[GROUPS_AT] + drive[DRIVE_GROUP]] > 0:
            continue
        end, late = motion(y1, floats, drive)
        start, early = motion(y0, floats, drive)
        for j in range(2):
            way = 1.0 if j == 0 else -1.0
            gap, left = way * (start - floats[drive[LIMITS_AT] + j]), way * (end - floats[drive[LIMITS_AT] + j])
            if not (gap > AT_STOP * h * abs(early) and left < 0.0 and fast(way * early, way * late)):
                continue
            low, high = 0.0, 1.0
            for _ in range(50):
                s = 0.5 * (low + high)
                bend = (1.0 - 2.0 * s) * (left - gap) + (s - 1.0) * h * way * early + s * h * way * late
                if (1.0 - s) * gap + s * left + s * (s - 1.0) * bend > 0.0:
                    low = s
                else:
                    high = s
            first = min(first, high)
    return first


@lean(types.void(A, I, N))
def rouse(floats, own, body):
    """Let the group of a body take part, which may touch something."""
    if own.size > 0 and own[own[BODY_GROUPS_AT] + body] >= 0:
        floats[own[ACTIVE_AT] + own[own[BODY_GROUPS_AT] + body]] = PRESSED


@lean_inlined
def write_jacobian(program, c, floats, j, sign, flipped):
    """Copy J of a row of ties, in the order of its two bodies."""
    for side in range(2):
        other = 1 - side if flipped == 1 else side
        for i in range(6):
            program[c + ROW_J + 6 * side + i] = sign * floats[j + 6 * other + i]


@lean_inlined
def bound(program, c, low, high, given):
    """Write bounds and given velocity of a row, and no impulse yet."""
    program[c + ROW_LOW], program[c + ROW_HIGH], program[c + ROW_GIVEN], program[c + ROW_X] = low, high, given, 0.0


@lean(types.void(F, A, A, A, I, A))
def write_ties(h, y0, y1, floats, own, rows):
    """Write the rows of ties and drives."""
    ties = own[own[TIES_AT] : own[TIES_AT] + own[TIES]]
    for late in range(2):
        survey(0.0, y1 if late == 1 else y0, floats, ties)
        for k in range(ties[TIE_ROWS]):
            row, c, side = ties[ROWS_AT] + ROW_INTS * k, ROW * k, own[SIDES_AT] + SIDE_INTS * k
            to, group = ties[row + SCRATCH], own[side + GROUP]
            mode = floats[own[ACTIVE_AT] + group] if group >= 0 else AWAY
            if late == 1 and mode != STRUCK:
                continue
            write_jacobian(rows, c, floats, to + AT_J, 1.0, own[side + FLIPPED])
            if mode == AWAY or floats[ties[row + HOLDS]] == 0.0:
                bound(rows, c, 0.0, 0.0, 0.0)
            elif late == 1:
                bound(rows, c, -math.inf, math.inf, floats[to + AT_SPEED])
                for side_of in range(2):  # what is led has its own speed, which the rows do not have
                    mover = ties[MOVED_AT] + MOVED * ties[row + FIRST + side_of]
                    if ties[ties[MOVERS_AT] + MOVER * ties[row + FIRST + side_of] + POSITION] >= 0:
                        for j in range(3):
                            part = floats[to + AT_J + 6 * side_of + j] * floats[mover + AT_V + j]
                            rows[c + ROW_GIVEN] -= part
                            part = floats[to + AT_J + 6 * side_of + 3 + j] * floats[mover + AT_W + j]
                            rows[c + ROW_GIVEN] -= part
            else:
                bound(rows, c, -math.inf, math.inf, floats[to + AT_C] / h)
    for k in range(own[DRIVES]):
        drive = own[drive_of(own, k) : drive_of(own, k) + DRIVE]
        c = ROW * (ties[TIE_ROWS] + 4 * k)
        mode = floats[own[ACTIVE_AT] + drive[DRIVE_GROUP]]
        _, will = motion(y1, floats, drive)
        far, was = motion(y0, floats, drive)
        if mode == STRUCK:
            far, _ = motion(y1, floats, drive)
        for j in range(4):
            sign = -1.0 if j == 1 else 1.0
            write_jacobian(rows, c + ROW * j, floats, drive[ROW_AT + SCRATCH] + AT_J, sign, drive[DRIVE_FLIPPED])
            bound(rows, c + ROW * j, 0.0, 0.0, 0.0)
        if floats[drive[ROW_AT + HOLDS]] == 0.0 or mode == AWAY:
            continue
        if drive[LIMITS_AT] >= 0:
            rebound = floats[drive[REBOUND_AT]]
            for j in range(2):
                way = 1.0 if j == 0 else -1.0
                gap, early, late = way * (far - floats[drive[LIMITS_AT] + j]), way * was, way * will
                if mode == STRUCK:
                    if abs(gap) <= AT_STOP * h * abs(late):
                        bound(rows, c + ROW * j, 0.0, math.inf, rebound * late if fast(early, late) else 0.0)
                    continue
                given = gap / h
                if gap + h * late < 0.0 and rebound > 0.0 and fast(early, late):
                    given = rebound * early
                bound(rows, c + ROW * j, 0.0, math.inf, given)
        if drive[MOTOR] != NO_MOTOR:
            most, target = h * floats[drive[MOST_AT]], floats[drive[TARGET_AT]]
            if drive[MOTOR] == ANGLE:
                reached = floats[drive[REACHED_AT]]
                target = (target - reached) / h + (reached - far) / max(h, floats[drive[SETTLING_AT]])
            bound(rows, c + 2 * ROW, -most, most, -target)
        if drive[FRICTION_AT] >= 0:
            most = h * floats[drive[FRICTION_AT]]
            bound(rows, c + 3 * ROW, -most, most, 0.0)
