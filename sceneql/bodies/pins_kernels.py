# mypy: ignore-errors
"""Pins that move.

A pin that has been released has an inverse mass above 0.
"""

import sceneql.system.channels as channels
from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

POSITION_AT, VELOCITY_AT, WORK_AT, MASS_AT, INVERSE_AT = range(5)
EARLIER, NOW, LATER, APART, STARTS, UNTIL, COUNT, MASSES = range(5, 13)
"""Floats' places of the shift a little earlier, now and a little later (3 each), of that little time, of the masses'
starts (3 each) and of the time at which they are let go; the number of masses, and from MASSES on the masses."""
EPSILON, SAFE = 2.0**-52, 100.0
"""Relative rounding error of a number, and the accumulated multiple of it beyond which a pin is moved into place."""


@inlined
def velocity(floats, ints, c):
    """Component of the prescribed velocity."""
    found = (floats[ints[LATER] + c] - floats[ints[EARLIER] + c]) / (2.0 * floats[ints[APART]])
    return found if floats[channels.STATIC] == 0.0 else 0.0


@inlined
def acceleration(floats, ints, c):
    """Component of the prescribed acceleration."""
    apart = floats[ints[APART]]
    sides = floats[ints[LATER] + c] + floats[ints[EARLIER] + c]
    found = (sides - 2.0 * floats[ints[NOW] + c]) / (apart * apart)
    return found if floats[channels.STATIC] == 0.0 else 0.0


@inlined
def leading(x, floats, ints, k, c):
    """Rate of a component x of the position of the k-th mass."""
    off = floats[ints[STARTS] + 3 * k + c] + floats[ints[NOW] + c] - x
    return off if floats[channels.STATIC] == channels.PLACING else velocity(floats, ints, c)


@kernel(TERM, inner=True)
def toil(t, y, rate, floats, ints):
    """Subtract the power that moves the pins against their springs from the work; runs right after the springs."""
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[INVERSE_AT] + mass] > 0.0:
            continue
        for c in range(3):
            at = ints[VELOCITY_AT] + 3 * mass + c
            rate[ints[WORK_AT]] += (rate[at] - floats[ints[MASS_AT] + mass] * acceleration(floats, ints, c)) * y[at]


@kernel(TERM, inner=True)
def lead(t, y, rate, floats, ints):
    """The prescribed velocity and acceleration."""
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[INVERSE_AT] + mass] > 0.0:
            continue
        for c in range(3):
            x = ints[POSITION_AT] + 3 * mass + c
            rate[x] = leading(y[x], floats, ints, k, c)
            rate[ints[VELOCITY_AT] + 3 * mass + c] = acceleration(floats, ints, c)


@inlined
def rounding(floats, ints, place, order, h):
    """Rounding error of a place [m] (order 0) or velocity [m/s] (1) after a step of length h, from the differences.

    The error of the acceleration is some EPSILON |place| / APART^2.
    """
    apart = floats[ints[APART]]
    return SAFE * EPSILON * place * (1.0 + h / apart) ** (2 - order) / apart**order


@kernel(AFTER_STEP, inner=True)
def put(t0, t1, y0, rate0, y1, floats, ints):
    """Move the pins to their prescribed places at the end of a step (keyframes may have kinks); release those due.

    A pin that is off by rounding alone is left as it is, so that multistep methods and dense output keep the solver's
    own state. Returns whether any pin was moved or released.
    """
    changed = False
    for k in range(ints[COUNT]):
        mass = ints[MASSES + k]
        if floats[ints[INVERSE_AT] + mass] > 0.0:
            continue
        for c in range(3):
            start, shift, speed = floats[ints[STARTS] + 3 * k + c], floats[ints[NOW] + c], velocity(floats, ints, c)
            x, v = ints[POSITION_AT] + 3 * mass + c, ints[VELOCITY_AT] + 3 * mass + c
            size = abs(start) + abs(shift)
            if abs(start + shift - y1[x]) > rounding(floats, ints, size, 0, t1 - t0) or abs(speed - y1[v]) > rounding(
                floats, ints, size, 1, t1 - t0
            ):
                y1[x] = start + shift
                y1[v] = speed
                changed = True
        if t1 >= floats[ints[UNTIL]]:
            floats[ints[INVERSE_AT] + mass] = 1.0 / floats[ints[MASS_AT] + mass]
            changed = True
    return changed
