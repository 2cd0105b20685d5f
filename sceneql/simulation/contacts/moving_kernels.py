# mypy: ignore-errors
"""How an object's own points move: central differences of its poses."""

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.contacts.shape_kernels import AFTER, BEFORE, MOTION_TYPE, MOVING, inward, turn


@lean_inlined
def carried(floats, ints, at, pose, x, y, z):
    """Where a point that is fixed to the object stands in its pose BEFORE or AFTER."""
    a, b, c = inward(floats, ints, at, x, y, z)
    a, b, c = turn(floats, ints[at + pose + 1], a, b, c)
    p = ints[at + pose]
    return a + floats[p], b + floats[p + 1], c + floats[p + 2]


@lean(MOTION_TYPE, inner=True)
def moving_velocity(floats, ints, at, x, y, z):
    """Velocity [m/s] of the point at (x, y, z) of one that moves."""
    apart = floats[ints[at + MOVING]]
    a, b, c = carried(floats, ints, at, BEFORE, x, y, z)
    p, q, r = carried(floats, ints, at, AFTER, x, y, z)
    return (p - a) / (2.0 * apart), (q - b) / (2.0 * apart), (r - c) / (2.0 * apart)


@lean(MOTION_TYPE, inner=True)
def moving_acceleration(floats, ints, at, x, y, z):
    """Acceleration [m/s^2] of the same."""
    apart = floats[ints[at + MOVING]]
    a, b, c = carried(floats, ints, at, BEFORE, x, y, z)
    p, q, r = carried(floats, ints, at, AFTER, x, y, z)
    square = apart * apart
    return (p - 2.0 * x + a) / square, (q - 2.0 * y + b) / square, (r - 2.0 * z + c) / square
