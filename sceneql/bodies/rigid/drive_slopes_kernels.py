# mypy: ignore-errors
"""The derivatives of what acts along the motion that a hinge or a slider leaves, by central differences."""

import numpy as np

from sceneql.bodies.rigid.drive_kernels import (
    DAMPING_AT,
    FORCE_AT,
    REST_AT,
    ROW_AT,
    SCRATCH_AT,
    STIFFNESS_AT,
    motion,
)
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_J, HOLDS, MOVED, MOVER, ROTATION, SCRATCH
from sceneql.bodies.rigid.ties.tie_slopes_kernels import OWN, difference, entry_of, moves
from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import TERM

ENTRIES = 12 * 2 * OWN
"""Rows: velocity and momentum of both bodies; columns: the numbers of both."""


@inlined
def push(y, floats, ints, out):
    """Write the forces and torques (12,) on both bodies."""
    far, fast = motion(y, floats, ints)
    total = floats[ints[FORCE_AT]] - floats[ints[DAMPING_AT]] * fast
    total -= floats[ints[STIFFNESS_AT]] * (far - floats[ints[REST_AT]])
    to = ints[ROW_AT + SCRATCH] + AT_J
    for c in range(12):
        out[c] = total * floats[to + c]


@kernel(TERM, inner=True)
def drive(t, y, entries, floats, ints):
    """Of each of the 12 rows the slopes by both bodies' numbers."""
    if floats[ints[ROW_AT + HOLDS]] == 0.0:
        return
    more, less = np.zeros(12), np.zeros(12)
    push(y, floats, ints, less)
    for side in range(2):
        at, body = MOVER * side, ints[SCRATCH_AT] + MOVED * side
        if not moves(floats, ints, at, body):
            continue
        for c in range(OWN):
            i = entry_of(ints, at, c)
            if i < 0:
                continue
            kept = y[i]
            step = (kept + difference(y, floats, ints, at, body, c)) - kept
            y[i] = kept + step
            push(y, floats, ints, more)
            y[i] = kept - step
            push(y, floats, ints, less)
            y[i] = kept
            for row in range(12):
                acted = row // 6
                turns = row % 6 < 3 or ints[MOVER * acted + ROTATION] >= 0
                if turns and moves(floats, ints, MOVER * acted, ints[SCRATCH_AT] + MOVED * acted):
                    entries[2 * OWN * row + OWN * side + c] += 0.5 * (more[row] - less[row]) / step
        push(y, floats, ints, less)
