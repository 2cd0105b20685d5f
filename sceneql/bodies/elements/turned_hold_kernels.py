# mypy: ignore-errors
"""Nodes that are held in some components, and moved and turned with an object.

In an implicit stage x = base + a v that terms know of, velocities are those that end the stage at the object's pose, so
that nothing is put in place after steps and multistep methods go on with what they remember.
"""

import sceneql.system.channels as channels
from sceneql.bodies.pins_kernels import POSITION_AT, VELOCITY_AT, WORK_AT, rounding
from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

EARLIER, NOW, APART, LATER, ARMS, FORCE_AT, HELD = 4, 6, 8, 9, 11, 12, 13
WHOLE, COUNT, NEAR, WEIGHTS_AT, LISTS = range(16, 21)
"""Behind offsets of the bodies' position, velocity, work and mass: of the object's position and rotation a little
earlier and now, of that little time (where pins have it), of the pose a little later, of the nodes' places in the
object's axes (3 each), of the force [N] with, behind it, for each node the sum of all other forces (3) and of the
solid's own (3); whether each of three components is held, and whether all; how many nodes; how many nodes whose
acceleration their inertia feels; offset of the inertia's weights [kg]. At LISTS: the nodes; those others; whether their
components are free; where each node's weights begin, and the end; the number of the other node of each weight."""


@lean_inlined
def place(floats, ints, k, pose):
    """Where a node is with the object in a pose."""
    arm = ints[ARMS] + 3 * k
    x, y, z = to_world(floats, ints[pose + 1], floats[arm], floats[arm + 1], floats[arm + 2])
    p = ints[pose]
    return x + floats[p], y + floats[p + 1], z + floats[p + 2]


@lean_inlined
def motion(y, floats, ints, k, c):
    """(velocity, acceleration) of a component of a node."""
    if floats[channels.STATIC] != 0.0:
        return 0.0, 0.0
    apart = floats[ints[APART]]
    before, after = place(floats, ints, k, EARLIER)[c], place(floats, ints, k, LATER)[c]
    here = place(floats, ints, k, NOW)[c]
    a = floats[channels.STAGE]
    if a > 0.0:
        base = floats.size - channels.BASE * y.size
        at = base + 3 * ints[LISTS + k] + c
        v = (here - floats[at + ints[POSITION_AT]]) / a
        return v, (v - floats[at + ints[VELOCITY_AT]]) / a
    return (after - before) / (2.0 * apart), (after - 2.0 * here + before) / (apart * apart)


@lean_inlined
def note(rate, floats, ints, to):
    """Store the forces so far on the nodes."""
    for k in range(ints[COUNT]):
        for c in range(3):
            floats[to + 3 * k + c] = rate[ints[VELOCITY_AT] + 3 * ints[LISTS + k] + c]


@lean(TERM, inner=True)
def feel_strain(t, y, rate, floats, ints):
    """Store the solid's own forces on the nodes; runs right after these."""
    note(rate, floats, ints, ints[FORCE_AT] + 3 + 3 * ints[COUNT])


@lean(TERM, inner=True)
def feel(t, y, rate, floats, ints):
    """Store all other forces on the nodes; what is led by its inertia pulls on its neighbors."""
    note(rate, floats, ints, ints[FORCE_AT] + 3)
    near = LISTS + ints[COUNT]
    free = near + ints[NEAR]
    rows = free + 3 * ints[NEAR]
    columns = rows + ints[COUNT] + 1
    for k in range(ints[COUNT]):
        for c in range(3):
            if ints[HELD + c] == 0:
                continue
            pull = motion(y, floats, ints, k, c)[1]
            for m in range(ints[rows + k], ints[rows + k + 1]):
                other = ints[columns + m]
                if ints[free + 3 * other + c] == 1:
                    rate[ints[VELOCITY_AT] + 3 * ints[near + other] + c] -= floats[ints[WEIGHTS_AT] + m] * pull


@lean(TERM, inner=True)
def lead(t, y, rate, floats, ints):
    """The prescribed velocities and accelerations."""
    for k in range(ints[COUNT]):
        for c in range(3):
            if ints[HELD + c] == 1:
                at = 3 * ints[LISTS + k] + c
                rate[ints[POSITION_AT] + at], rate[ints[VELOCITY_AT] + at] = motion(y, floats, ints, k, c)
                if floats[channels.STATIC] == channels.PLACING:
                    rate[ints[POSITION_AT] + at] = place(floats, ints, k, NOW)[c] - y[ints[POSITION_AT] + at]


@lean(TERM, inner=True)
def tell(t, y, rate, floats, ints):
    """Store the force of the hold, and subtract its power from the work (hold_kernels.tell)."""
    near, force = LISTS + ints[COUNT], ints[FORCE_AT]
    rows = near + 4 * ints[NEAR]
    columns = rows + ints[COUNT] + 1
    for c in range(3):
        floats[force + c] = 0.0
        if ints[HELD + c] == 0:
            continue
        for k in range(ints[COUNT]):
            needed = 0.0
            for m in range(ints[rows + k], ints[rows + k + 1]):
                other = ints[near + ints[columns + m]]
                needed += floats[ints[WEIGHTS_AT] + m] * rate[ints[VELOCITY_AT] + 3 * other + c]
            own = force + 3 + 3 * k + c
            floats[force + c] += needed - floats[own]
            others = floats[own + 3 * ints[COUNT]] if ints[WHOLE] == 1 else floats[own]
            rate[ints[WORK_AT]] -= (needed - others) * motion(y, floats, ints, k, c)[0]


@lean(AFTER_STEP, inner=True)
def put(t0, t1, y0, rate0, y1, floats, ints):
    """Move the nodes to their prescribed places at the end of a step, where they are off by more than rounding."""
    changed = False
    for k in range(ints[COUNT]):
        for c in range(3):
            if ints[HELD + c] == 0:
                continue
            here, (v, _) = place(floats, ints, k, NOW)[c], motion(y1, floats, ints, k, c)
            at = 3 * ints[LISTS + k] + c
            x, u = ints[POSITION_AT] + at, ints[VELOCITY_AT] + at
            apart = floats[ints[APART]]
            off, slow = abs(here - y1[x]), abs(v - y1[u])
            size = 1.0 + abs(here)
            first, second = rounding(floats, ints, size, 0, t1 - t0), rounding(floats, ints, size, 1, t1 - t0)
            if off > first or (floats[channels.STAGE] == channels.NO_SLOPES and slow > second and apart > 0.0):
                y1[x], y1[u] = here, v
                changed = True
    return changed
