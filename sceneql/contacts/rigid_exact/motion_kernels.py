# mypy: ignore-errors
"""The motion that a tie leaves, as exact contacts need it (stop_kernels): compiled where a tie has stops or a motor."""

import math

from numba import types

from sceneql.bodies.rigid.drive_kernels import (
    ANGLE,
    DRIVE_INTS,
    FRICTION_AT,
    LIMITS_AT,
    MOST_AT,
    MOTOR,
    NO_MOTOR,
    REBOUND_AT,
    ROW_AT,
    SCRATCH_AT,
    SETTLING_AT,
    TARGET_AT,
    motion,
)
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_BIAS, AT_J, AT_W, HOLDS, KIND, MOVED, POINT, SCRATCH, cross
from sceneql.compiled.kernels import kernel
from sceneql.contacts.rigid_exact import stop_kernels as own
from sceneql.contacts.rigid_exact.contact_kernels import dot, three
from sceneql.system.signatures_kernels import A, I, N

RATE_AT, BEND_AT, DRIVE = range(DRIVE_INTS, DRIVE_INTS + 3)
"""Integers behind those of drive_kernels: offsets of the first and of the second derivative of what a motor follows in
time (-1: it is constant)."""


@kernel(types.void(A, A, I, N), inner=True)
def see_motion(y, floats, ints, to):
    """Write to floats[to:] what the state says of the motion that a tie leaves."""
    far, fast = motion(y, floats, ints)
    floats[to + own.FAR], floats[to + own.FAST] = far, fast
    row = ints[ROW_AT + SCRATCH]
    if ints[ROW_AT + KIND] == POINT:
        floats[to + own.DRIFT] = floats[row + AT_BIAS]
    else:  # about an axis of b, which turns with it
        a, b = ints[SCRATCH_AT], ints[SCRATCH_AT] + MOVED
        nx, ny, nz = cross(*three(floats, b + AT_W), *three(floats, row + AT_J + 3))
        floats[to + own.DRIFT] = dot(nx, ny, nz, *three(floats, a + AT_W))
    floats[to + own.LEAST], floats[to + own.GREATEST] = -math.inf, math.inf
    for j in range(2):
        floats[to + own.TARGETS + j] = floats[to + own.TARGET_RATES + j] = floats[to + own.MOSTS + j] = 0.0
    if floats[ints[ROW_AT + HOLDS]] == 0.0:
        return
    if ints[LIMITS_AT] >= 0:
        floats[to + own.LEAST], floats[to + own.GREATEST] = floats[ints[LIMITS_AT]], floats[ints[LIMITS_AT] + 1]
        floats[to + own.REBOUND] = floats[ints[REBOUND_AT]]
    if ints[MOTOR] != NO_MOTOR:
        target = floats[ints[TARGET_AT]]
        first = floats[ints[RATE_AT]] if ints[RATE_AT] >= 0 else 0.0
        second = floats[ints[BEND_AT]] if ints[BEND_AT] >= 0 else 0.0
        if ints[MOTOR] == ANGLE:
            inverse = 1.0 / floats[ints[SETTLING_AT]]
            target, first = first + inverse * (target - far), second + inverse * (first - fast)
        floats[to + own.TARGETS], floats[to + own.TARGET_RATES] = target, first
        floats[to + own.MOSTS] = floats[ints[MOST_AT]]
    if ints[FRICTION_AT] >= 0:
        floats[to + own.MOSTS + 1] = floats[ints[FRICTION_AT]]
