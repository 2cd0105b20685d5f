# mypy: ignore-errors
"""Nodes that are held in some components, and moved."""

from sceneql.bodies.pins_kernels import (
    MASS_AT,
    NOW,
    POSITION_AT,
    STARTS,
    VELOCITY_AT,
    WORK_AT,
    acceleration,
    rounding,
    velocity,
)
from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

FORCE_AT, HELD, COUNT, NODES = 10, 11, 14, 15
"""Behind the integers of a pin up to STARTS: offset of the force [N], whether each of three components is held, how
many nodes, and these."""


@kernel(TERM, inner=True)
def feel(t, y, rate, floats, ints):
    """Store the force of the hold: what its nodes need besides all other forces; runs when these are added up."""
    for c in range(3):
        total = 0.0
        if ints[HELD + c] == 1:
            for k in range(ints[COUNT]):
                node = ints[NODES + k]
                total += floats[ints[MASS_AT] + node] * acceleration(floats, ints, c)
                total -= rate[ints[VELOCITY_AT] + 3 * node + c]
        floats[ints[FORCE_AT] + c] = total


@kernel(TERM, inner=True)
def toil(t, y, rate, floats, ints):
    """Subtract the power that moves the nodes against the forces so far from the work."""
    for k in range(ints[COUNT]):
        node = ints[NODES + k]
        for c in range(3):
            if ints[HELD + c] == 1:
                at = ints[VELOCITY_AT] + 3 * node + c
                need = floats[ints[MASS_AT] + node] * acceleration(floats, ints, c)
                rate[ints[WORK_AT]] += (rate[at] - need) * y[at]


@kernel(TERM, inner=True)
def lead(t, y, rate, floats, ints):
    """The prescribed velocity and acceleration."""
    for k in range(ints[COUNT]):
        for c in range(3):
            if ints[HELD + c] == 1:
                at = 3 * ints[NODES + k] + c
                rate[ints[POSITION_AT] + at] = velocity(floats, ints, c)
                rate[ints[VELOCITY_AT] + at] = acceleration(floats, ints, c)


@kernel(AFTER_STEP, inner=True)
def put(t0, t1, y0, rate0, y1, floats, ints):
    """Move the nodes to their prescribed places at the end of a step, where they are off by more than rounding."""
    changed = False
    for k in range(ints[COUNT]):
        for c in range(3):
            if ints[HELD + c] == 0:
                continue
            start, shift, speed = floats[ints[STARTS] + 3 * k + c], floats[ints[NOW] + c], velocity(floats, ints, c)
            x, v = ints[POSITION_AT] + 3 * ints[NODES + k] + c, ints[VELOCITY_AT] + 3 * ints[NODES + k] + c
            size = abs(start) + abs(shift)
            if abs(start + shift - y1[x]) > rounding(floats, ints, size, 0, t1 - t0) or abs(speed - y1[v]) > rounding(
                floats, ints, size, 1, t1 - t0
            ):
                y1[x] = start + shift
                y1[v] = speed
                changed = True
    return changed
