# mypy: ignore-errors
"""The one motion that a hinge or a slider leaves: how far and how fast it is, and the force along it."""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_C,
    AT_J,
    AT_R,
    AT_SPEED,
    AT_W,
    HOLDS,
    MOMENTUM,
    MOVED,
    MOVER,
    NUMBERS,
    PLACE,
    POINT,
    POSITION,
    ROTATION,
    ROW_INTS,
    SCRATCH,
    TURN,
    VELOCITY,
    put,
    see,
    turned,
    write_row,
    write_turn,
)
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, F, I

ROW_AT, SCRATCH_AT = 2 * MOVER, 2 * MOVER + ROW_INTS
FORCE_AT, STIFFNESS_AT, REST_AT, DAMPING_AT, WORK_AT, GIVEN_AT, LAST_AT = range(SCRATCH_AT + 1, SCRATCH_AT + 8)
"""Behind two movers and a row (tie_rows_kernels): offsets of what `see` writes of both, in a place that all ties share;
of the force, of stiffness, rest and damping; of the work in y, and there of the energy that the force gave (-1: none);
of how far it was at the end of the last step, by which turns are counted. A row of kind POINT is a shift along n_b; any
other a turn about n_b, its numbers directions across that axis, one of a and one of b, and n_b."""
(LIMITS_AT, REBOUND_AT, MOTOR, TARGET_AT, MOST_AT, SETTLING_AT, REACHED_AT, FRICTION_AT, EFFORT_AT, DRIVE_INTS) = range(
    LAST_AT + 1, LAST_AT + 11
)
"""Behind these, of what acts in bounds: offsets of both limits and of the restitution (-1: none); what its motor
follows, offsets of that, of the largest force, of the time in which a motor takes errors of an angle away, and of the
angle that it followed last; of the friction (-1: none); of what all of these do along the motion."""
NO_MOTOR, SPEED, ANGLE = range(3)
"""What a motor follows."""


@lean_inlined
def angle_of(floats, ints, a, b):
    """How far [rad] a turned against b, whose rotations stand at floats[a:] and floats[b:]; and the axis, in the
    world's axes."""
    own = ints[ROW_AT + NUMBERS]
    px, py, pz = turned(floats, a + AT_R, floats[own], floats[own + 1], floats[own + 2])
    qx, qy, qz = turned(floats, b + AT_R, floats[own + 3], floats[own + 4], floats[own + 5])
    nx, ny, nz = turned(floats, b + AT_R, floats[own + 6], floats[own + 7], floats[own + 8])
    sine = nx * (qy * pz - qz * py) + ny * (qz * px - qx * pz) + nz * (qx * py - qy * px)
    angle = math.atan2(sine, qx * px + qy * py + qz * pz)
    turns = math.floor((floats[ints[LAST_AT]] - angle) / (2.0 * math.pi) + 0.5)
    return angle + 2.0 * math.pi * turns, nx, ny, nz


@lean_inlined
def see_rotation(y, floats, to, ints, at):
    """Write the rotation of the mover of ints[at:], which is no mass, to floats[to:], as `see` does."""
    m = floats[to : to + MOVED]
    if ints[at + ROTATION] >= 0:
        write_turn(y, ints[at + ROTATION], m)
    elif ints[at + PLACE] >= 0:
        write_turn(floats, ints[at + TURN], m)
    else:
        put(m, AT_R, 1.0, 0.0, 0.0)
        put(m, AT_R + 3, 0.0, 1.0, 0.0)
        put(m, AT_R + 6, 0.0, 0.0, 1.0)


@lean(types.UniTuple(F, 2)(A, A, I))
def motion(y, floats, ints):
    """How far [m or rad] and how fast [1/s of that] a has gone against b; the row's J is written."""
    a, b = ints[SCRATCH_AT], ints[SCRATCH_AT] + MOVED
    see(y, floats, a, ints, 0)
    see(y, floats, b, ints, MOVER)
    to = ints[ROW_AT + SCRATCH]
    if ints[ROW_AT] == POINT:
        write_row(floats, ints, ROW_AT, a, b)
        return floats[to + AT_C], floats[to + AT_SPEED]
    angle, nx, ny, nz = angle_of(floats, ints, a, b)
    for k in range(12):
        floats[to + AT_J + k] = 0.0
    put(floats, to + AT_J + 3, nx, ny, nz)
    put(floats, to + AT_J + 9, -nx, -ny, -nz)
    speed = nx * (floats[a + AT_W] - floats[b + AT_W]) + ny * (floats[a + AT_W + 1] - floats[b + AT_W + 1])
    speed += nz * (floats[a + AT_W + 2] - floats[b + AT_W + 2])
    return angle, speed


@kernel(TERM, inner=True)
def drive(t, y, rate, floats, ints):
    """Adds force - stiffness (s - rest) - damping s' along the motion, and what force and damping take to the work."""
    if floats[ints[ROW_AT + HOLDS]] == 0.0:
        return
    far, fast = motion(y, floats, ints)
    given, lost = floats[ints[FORCE_AT]], floats[ints[DAMPING_AT]] * fast
    total = given - lost - floats[ints[STIFFNESS_AT]] * (far - floats[ints[REST_AT]])
    to = ints[ROW_AT + SCRATCH] + AT_J
    for side in range(2):
        at = MOVER * side
        if ints[at + POSITION] >= 0:
            for c in range(3):
                rate[ints[at + VELOCITY] + c] += total * floats[to + 6 * side + c]
            if ints[at + ROTATION] >= 0:
                for c in range(3):
                    rate[ints[at + MOMENTUM] + c] += total * floats[to + 6 * side + 3 + c]
    rate[ints[WORK_AT]] += (lost - given) * fast
    if ints[GIVEN_AT] >= 0:
        rate[ints[GIVEN_AT]] += given * fast


@kernel(AFTER_STEP, inner=True)
def follow(t0, t1, y0, rate0, y1, floats, ints):
    """Keeps how far it is at the end of a step; nothing changes."""
    if t1 > t0:
        a, b = ints[SCRATCH_AT], ints[SCRATCH_AT] + MOVED
        see_rotation(y1, floats, a, ints, 0)
        see_rotation(y1, floats, b, ints, MOVER)
        floats[ints[LAST_AT]] = angle_of(floats, ints, a, b)[0]
    return False
