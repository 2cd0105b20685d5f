# mypy: ignore-errors
"""Pins that move.

ints of all kernels: position_at, velocity_at, work_at, mass_at, inverse_at, then floats' places of the shift a little
earlier, now and a little later (3 each), of that little time, of the masses' starts (3 each) and of the time at which
they are let go; the number of masses, and the masses. One that has been let go has an inverse mass above 0.
"""

from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

EARLIER, NOW, LATER, APART, STARTS, UNTIL, COUNT, MASSES = range(5, 13)
EPSILON, SAFE = 2.0**-52, 8.0
"""Relative rounding of a number, and how many of it a difference may have."""


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


@inlined
def rounding(floats, ints, place, order, h):
    """What rounding of the differences makes of a place [m], or of its rate of an order, in a step of length h."""
    apart = floats[ints[APART]]
    return SAFE * EPSILON * abs(place) * (1.0 + h / apart) / apart**order


@kernel(AFTER_STEP, inner=True)
def put(t0, t1, y0, rate0, y1, floats, ints):
    """Put the pins where they must be at the end of a step (keyframes may have kinks), and let go of them in time.

    Returns whether one was elsewhere, but for rounding, or was let go.
    """
    changed = False
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[4] + mass] > 0.0:
            continue
        for c in range(3):
            start, shift, speed = floats[ints[STARTS] + 3 * k + c], floats[ints[NOW] + c], velocity(floats, ints, c)
            x, v = ints[0] + 3 * mass + c, ints[1] + 3 * mass + c
            size = abs(start) + abs(shift)
            changed |= abs(start + shift - y1[x]) > rounding(floats, ints, size, 0, t1 - t0)
            changed |= abs(speed - y1[v]) > rounding(floats, ints, size, 1, t1 - t0)
            y1[x] = start + shift
            y1[v] = speed
        if t1 >= floats[ints[UNTIL]]:
            floats[ints[4] + mass] = 1.0 / floats[ints[3] + mass]
            changed = True
    return changed
