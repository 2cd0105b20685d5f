# mypy: ignore-errors
"""Nodes that are held in some components, and moved."""

from sceneql.bodies.pins_kernels import (
    NOW,
    POSITION_AT,
    STARTS,
    VELOCITY_AT,
    WORK_AT,
    acceleration,
    leading,
    rounding,
    velocity,
)
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

FORCE_AT, HELD, WHOLE, COUNT, NEAR, WEIGHTS_AT, NODES = 10, 11, 14, 15, 16, 17, 18
"""Behind the integers of a pin up to STARTS: offset of the force [N], followed by the sums of all other forces on the
nodes and of those of the solid itself; whether each of three components is held, and whether all; how many nodes; how
many nodes whose acceleration their inertia feels, offset of their weights [kg]; the nodes, those, and for each of those
whether its three components are free."""


@lean_inlined
def add_up(rate, floats, ints, to):
    """Store the sum of the forces so far on the nodes."""
    for c in range(3):
        floats[to + c] = 0.0
        for k in range(ints[COUNT]):
            floats[to + c] += rate[ints[VELOCITY_AT] + 3 * ints[NODES + k] + c]


@lean(TERM, inner=True)
def feel_strain(t, y, rate, floats, ints):
    """Store the sum of the solid's own forces on the nodes; runs right after these."""
    add_up(rate, floats, ints, ints[FORCE_AT] + 6)


@lean(TERM, inner=True)
def feel(t, y, rate, floats, ints):
    """Store the sum of all other forces on the nodes; what is led by its inertia pulls on its neighbors."""
    add_up(rate, floats, ints, ints[FORCE_AT] + 3)
    near = NODES + ints[COUNT]
    for k in range(ints[NEAR]):
        for c in range(3):
            if ints[HELD + c] == 1 and ints[near + ints[NEAR] + 3 * k + c] == 1:
                pull = floats[ints[WEIGHTS_AT] + k] * acceleration(floats, ints, c)
                rate[ints[VELOCITY_AT] + 3 * ints[near + k] + c] -= pull


@lean(TERM, inner=True)
def lead(t, y, rate, floats, ints):
    """The prescribed velocity and acceleration."""
    for k in range(ints[COUNT]):
        for c in range(3):
            if ints[HELD + c] == 1:
                at = 3 * ints[NODES + k] + c
                rate[ints[POSITION_AT] + at] = leading(y[ints[POSITION_AT] + at], floats, ints, k, c)
                rate[ints[VELOCITY_AT] + at] = acceleration(floats, ints, c)


@lean(TERM, inner=True)
def tell(t, y, rate, floats, ints):
    """Store the force of the hold, and subtract its power from the work; runs when accelerations are known.

    Of nodes that it holds whole, forces from outside have no potential (bodies.moving_masses), and are left out.
    """
    near, force = NODES + ints[COUNT], ints[FORCE_AT]
    for c in range(3):
        if ints[HELD + c] == 0:
            continue
        needed = 0.0
        for k in range(ints[NEAR]):
            needed += floats[ints[WEIGHTS_AT] + k] * rate[ints[VELOCITY_AT] + 3 * ints[near + k] + c]
        floats[force + c] = needed - floats[force + 3 + c]
        others = floats[force + 6 + c] if ints[WHOLE] == 1 else floats[force + 3 + c]
        rate[ints[WORK_AT]] -= (needed - others) * velocity(floats, ints, c)


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
