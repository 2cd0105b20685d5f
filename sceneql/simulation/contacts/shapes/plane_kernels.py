# mypy: ignore-errors
"""The half-space below a plane; size: its normal (3), of any length."""

import math

from sceneql.kernels import inlined, kernel
from sceneql.simulation.contacts.shape_kernels import (
    BEND_TYPE,
    CLEAR_TYPE,
    PLACE,
    ROTATION,
    SIZE,
    SURFACE_TYPE,
    turn,
)


@inlined
def facing(floats, ints, at, x, y, z):
    """Signed distance and normal."""
    place, size = ints[at + PLACE], ints[at + SIZE]
    a, b, c = turn(floats, ints[at + ROTATION], floats[size], floats[size + 1], floats[size + 2])
    scale = 1.0 / math.sqrt(a * a + b * b + c * c)
    a, b, c = a * scale, b * scale, c * scale
    return a * (x - floats[place]) + b * (y - floats[place + 1]) + c * (z - floats[place + 2]), a, b, c


@kernel(SURFACE_TYPE)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal."""
    return facing(floats, ints, at, x, y, z)


@kernel(BEND_TYPE)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """0: it is flat."""
    return 0.0


@kernel(CLEAR_TYPE)
def clear(floats, ints, at, x, y, z, radius):
    """By the distance."""
    return facing(floats, ints, at, x, y, z)[0] > radius
