# mypy: ignore-errors
"""A step of velocities with ties: solved with the contacts, closed, and what comes of it.

Ties hold at the end of the step: their rows at its start are corrected by the gaps that the motion along them leaves
(as SHAKE does: Ryckaert, Ciccotti & Berendsen 1977), with the contacts found anew.
"""

import math

import numpy as np
from numba import types

from sceneql.bodies.rigid.drive_kernels import (
    ANGLE,
    EFFORT_AT,
    LIMITS_AT,
    MOTOR,
    REACHED_AT,
    ROW_AT,
    TARGET_AT,
    motion,
)
from sceneql.bodies.rigid.groups_kernels import MASS
from sceneql.bodies.rigid.moved_bodies_kernels import (
    ACTIVE_AT,
    AWAY,
    BODY_GROUPS_AT,
    BODY_MOVERS_AT,
    DRIVES,
    FIRST_STEP,
    GROUPS,
    GROUPS_AT,
    PRESSED,
    ROW_BODIES_AT,
    SIDES_AT,
    STEADY,
    STRUCK,
    TIES,
    TIES_AT,
    mode_of,
)
from sceneql.bodies.rigid.point_list import AT_ARM_A, BODY_A, WHERE, WHO
from sceneql.bodies.rigid.point_list import AT_PUSH as POINT_PUSH
from sceneql.bodies.rigid.ties.tie_kernels import balance, clear, survey
from sceneql.bodies.rigid.ties.tie_layout import MOVED_AT, ROWS_AT
from sceneql.bodies.rigid.ties.tie_layout import ROWS as TIE_ROWS
from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_A,
    AT_C,
    AT_FORCE,
    AT_INVERSE,
    AT_MASS,
    AT_PUSH,
    AT_SIZE,
    AT_SPEED,
    HOLDS,
    MOVED,
    ROW_INTS,
    SCRATCH,
    cross,
    put,
    turned,
)
from sceneql.bodies.rigid.ties.tied_rows_kernels import (
    DRIVE,
    DRIVE_GROUP,
    GROUP,
    SIDE_INTS,
    drive_of,
    write_ties,
)
from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS, gather
from sceneql.compiled.kernels import kernel, lean
from sceneql.linear.cones.cone_layout_kernels import ROW, ROW_GIVEN, ROW_HIGH, ROW_J, ROW_X
from sceneql.system.signatures_kernels import A, F, I, N

CLOSED = 1e-13
"""Gap of a row, against the numbers that it is the difference of, that needs no further solution."""


@lean(types.boolean(F, A, A, I, A))
def close(h, y1, floats, own, rows):
    """Correct the rows by the gaps that the step leaves; whether one is more than rounding."""
    ties = own[own[TIES_AT] : own[TIES_AT] + own[TIES]]
    survey(0.0, y1, floats, ties)
    opened = False
    for k in range(ties[TIE_ROWS]):
        c, group = ROW * k, own[own[SIDES_AT] + SIDE_INTS * k + GROUP]
        mode = floats[own[ACTIVE_AT] + group] if group >= 0 else AWAY
        if rows[c + ROW_HIGH] == math.inf and (mode == PRESSED or mode == STEADY):
            to = ties[ties[ROWS_AT] + ROW_INTS * k + SCRATCH]
            # A steady group moves by half of what its velocities change: twice the gap.
            rows[c + ROW_GIVEN] += (2.0 if mode == STEADY else 1.0) * floats[to + AT_C] / h
            opened |= abs(floats[to + AT_C]) > CLOSED * floats[to + AT_SIZE]
    return opened


@lean(types.boolean(A, A, I, A))
def stopped(y1, floats, own, rows):
    """Whether a steady group has come to a stop: it is pressed from now on."""
    found, ties = False, own[own[TIES_AT] : own[TIES_AT] + own[TIES]]
    for k in range(own[DRIVES]):
        drive = own[drive_of(own, k) : drive_of(own, k) + DRIVE]
        at, c = own[ACTIVE_AT] + drive[DRIVE_GROUP], ROW * (ties[TIE_ROWS] + 4 * k)
        if floats[at] != STEADY or drive[LIMITS_AT] < 0 or floats[drive[ROW_AT + HOLDS]] == 0.0:
            continue
        far, _ = motion(y1, floats, drive)
        passed = far < floats[drive[LIMITS_AT]] or far > floats[drive[LIMITS_AT] + 1]
        if passed or rows[c + ROW_X] != 0.0 or rows[c + ROW + ROW_X] != 0.0:
            floats[at], found = PRESSED, True
    return found


@lean(types.boolean(F, A, A, A, A, I, A))
def again(h, y0, y1, free, floats, own, rows):
    """Whether ties ask for another solution, with the rows corrected; ``free``: the step's end without impulses."""
    if stopped(y1, floats, own, rows):
        write_ties(h, y0, free, floats, own, rows)
        return True
    return close(h, y1, floats, own, rows)


@lean(types.void(A, A, A, I, I, N, A, A))
def strike(y1, floats, masses, ints, own, bodies_at, motions, before):
    """Mass, inertia and velocities of what hits a stop at the end of the step, as they are there."""
    for k in range(masses.size // MASS):
        if mode_of(floats, own, k) == STRUCK:
            at = bodies_at + BODY_INTS * k
            gather(y1, y1, y1, floats, ints, at, masses, MASS * k, motions, before, 6 * k)


@kernel(types.boolean(I, A, I, A), inner=True)
def tied_to(touched, floats, own, rows):
    """Mark all that ties hold to what is touched, and whatever motors, friction and stops move; whether ties move any.

    ``touched`` (every,) or more: 1 for bodies that contacts have moved.
    """
    if own.size == 0:
        return False
    moved, ties, some = np.zeros(own[GROUPS]), own[own[TIES_AT] : own[TIES_AT] + own[TIES]], False
    for g in range(own[GROUPS]):
        moved[g] = float(own[own[GROUPS_AT] + g])
    for k in range(own[DRIVES]):
        for j in range(4):
            if rows[ROW * (ties[TIE_ROWS] + 4 * k + j) + ROW_X] != 0.0:
                moved[own[drive_of(own, k) + DRIVE_GROUP]] = 1.0
    every = own[BODY_MOVERS_AT] - own[BODY_GROUPS_AT]
    for body in range(every):
        group = own[own[BODY_GROUPS_AT] + body]
        if group >= 0 and touched[body] > 0:
            moved[group] = 1.0
    for body in range(every):
        group = own[own[BODY_GROUPS_AT] + body]
        if group >= 0 and moved[group] > 0.0:
            touched[body] = 1
            some = True
    return some


@kernel(types.void(F, A, A, I, A, I, A, N, N), inner=True)
def tell_forces(h, y0, floats, own, rows, who, where, contacts, n):
    """Write what the drives do, and the forces by which ties answer contacts and drives (AT_PUSH of their rows)."""
    ties = own[own[TIES_AT] : own[TIES_AT] + own[TIES]]
    survey(0.0, y0, floats, ties)
    clear(floats, ties)
    every = own[BODY_MOVERS_AT] - own[BODY_GROUPS_AT]
    pushes = np.zeros(6 * every)
    for k in range(contacts):
        at = WHERE * k
        x, y, z = where[at + POINT_PUSH], where[at + POINT_PUSH + 1], where[at + POINT_PUSH + 2]
        for side in range(2):
            body, arm, way = who[WHO * k + BODY_A + side], at + AT_ARM_A + 3 * side, (1.0 - 2.0 * side) / h
            if body < n:
                u, v, w = cross(where[arm], where[arm + 1], where[arm + 2], x, y, z)
                to = 6 * body
                put(pushes, to, pushes[to] + way * x, pushes[to + 1] + way * y, pushes[to + 2] + way * z)
                to += 3
                put(pushes, to, pushes[to] + way * u, pushes[to + 1] + way * v, pushes[to + 2] + way * w)
    for k in range(own[DRIVES]):
        drive, effort = own[drive_of(own, k) : drive_of(own, k) + DRIVE], 0.0
        for j in range(4):
            number = ties[TIE_ROWS] + 4 * k + j
            c, sides = ROW * number, own[ROW_BODIES_AT] + 2 * number
            effort += (-1.0 if j == 1 else 1.0) * rows[c + ROW_X] / h
            for side in range(2):
                if own[sides + side] >= 0:
                    for i in range(6):
                        pushes[6 * own[sides + side] + i] += rows[c + ROW_X] * rows[c + ROW_J + 6 * side + i] / h
        floats[drive[EFFORT_AT]] = effort
    for body in range(every):
        mover = own[own[BODY_MOVERS_AT] + body]
        if mover >= 0:
            to, p = ties[MOVED_AT] + MOVED * mover, 6 * body
            for j in range(3):
                floats[to + AT_A + j] = floats[to + AT_MASS] * pushes[p + j]
            put(floats, to + AT_A + 3, *turned(floats, to + AT_INVERSE, pushes[p + 3], pushes[p + 4], pushes[p + 5]))
    for k in range(ties[TIE_ROWS]):
        floats[ties[ties[ROWS_AT] + ROW_INTS * k + SCRATCH] + AT_SPEED] = 0.0
    balance(floats, ties, AT_SPEED, AT_SPEED)
    for k in range(ties[TIE_ROWS]):
        to = ties[ties[ROWS_AT] + ROW_INTS * k + SCRATCH]
        floats[to + AT_PUSH] = floats[to + AT_FORCE] + (0.0 if own[FIRST_STEP] == 1 else floats[to + AT_PUSH])


@lean(types.void(A, I, A, A, A))
def tell_work(floats, own, rows, found, before):
    """Add what motors gave in the step to the bodies that are solved, behind their efforts."""
    for k in range(own[DRIVES]):
        drive = own[drive_of(own, k) : drive_of(own, k) + DRIVE]
        number = own[own[TIES_AT] + TIE_ROWS] + 4 * k + 2
        c, sides, speed = ROW * number, own[ROW_BODIES_AT] + 2 * number, 0.0
        # As in `move`: of a steady group the mean velocity of the step, else that at its end.
        part = 0.5 if floats[own[ACTIVE_AT] + drive[DRIVE_GROUP]] == STEADY else 1.0
        for side in range(2):
            if own[sides + side] >= 0:
                of = 6 * own[sides + side]
                for i in range(6):
                    mean = part * found[of + i] + (1.0 - part) * before[of + i]
                    speed += rows[c + ROW_J + 6 * side + i] * mean
        floats[drive[EFFORT_AT] + 2] += rows[c + ROW_X] * speed


@lean(types.void(A, I))
def forget(floats, own):
    """No force by which ties answer contacts."""
    ties = own[own[TIES_AT] : own[TIES_AT] + own[TIES]]
    for k in range(ties[TIE_ROWS]):
        floats[ties[ties[ROWS_AT] + ROW_INTS * k + SCRATCH] + AT_PUSH] = 0.0


@kernel(types.void(F, A, A, I, A, I, A, N, N, types.boolean), inner=True)
def end_ties(h, y0, floats, own, rows, who, where, contacts, n, some):
    """What is told of ties at the end of the step, and the angles that motors followed; ``some``: ties moved bodies."""
    if some:
        tell_forces(h, y0, floats, own, rows, who, where, contacts, n)
    elif own[FIRST_STEP] == 1:
        forget(floats, own)
    for k in range(own[DRIVES]):
        drive = own[drive_of(own, k) : drive_of(own, k) + DRIVE]
        if drive[MOTOR] == ANGLE:
            floats[drive[REACHED_AT]] = floats[drive[TARGET_AT]]
