# mypy: ignore-errors
"""Pins that move.

ints of all kernels: position_at, velocity_at, work_at, mass_at, inverse_at, then floats' places of the shift a little
earlier, now and a little later (3 each), of that little time, of the masses' starts (3 each) and of the time at which
they are let go; the number of masses, and the masses. One that has been let go has an inverse mass above 0.
"""

from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import BACK_OFF, TERM

CHANGED_AT = 1
"""floats[1]: above 0 in a settling that is to change nothing (march_kernels)."""

EARLIER, NOW, LATER, APART, STARTS, UNTIL, COUNT, MASSES = range(5, 13)


@inlined
def velocity(floats, ints, c):
    """Component of the prescribed velocity."""
    return (floats[ints[LATER] + c] - floats[ints[EARLIER] + c]) / (2.0 * floats[ints[APART]])


@inlined
def acceleration(floats, ints, c):
    """Component of the prescribed acceleration."""
    apart = floats[ints[APART]]
    sides = floats[ints[LATER] + c] + floats[ints[EARLIER] + c]
    return (sides - 2.0 * floats[ints[NOW] + c]) / (apart * apart)


@kernel(TERM, inner=True)
def toil(t, y, rate, floats, ints):
    """The power that leads the pins against their springs, taken off the work; after the springs, before all else."""
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[4] + mass] > 0.0:
            continue
        for c in range(3):
            at = ints[1] + 3 * mass + c
            rate[ints[2]] += (rate[at] - floats[ints[3] + mass] * acceleration(floats, ints, c)) * y[at]


@kernel(TERM, inner=True)
def lead(t, y, rate, floats, ints):
    """The prescribed velocity and acceleration."""
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[4] + mass] > 0.0:
            continue
        for c in range(3):
            rate[ints[0] + 3 * mass + c] = velocity(floats, ints, c)
            rate[ints[1] + 3 * mass + c] = acceleration(floats, ints, c)


@kernel(BACK_OFF, inner=True)
def put(t0, t1, y0, rate0, y1, floats, ints):
    """Put the pins where they must be at the end of a step (keyframes may have kinks), and let go of them in time."""
    if floats[CHANGED_AT] > 0.0:
        return
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[4] + mass] > 0.0:
            continue
        for c in range(3):
            y1[ints[0] + 3 * mass + c] = floats[ints[STARTS] + 3 * k + c] + floats[ints[NOW] + c]
            y1[ints[1] + 3 * mass + c] = velocity(floats, ints, c)
        if t1 >= floats[ints[UNTIL]]:
            floats[ints[4] + mass] = 1.0 / floats[ints[3] + mass]
