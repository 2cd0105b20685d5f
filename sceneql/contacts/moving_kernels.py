# mypy: ignore-errors
"""Velocities and accelerations of an object's points, and paths in its frame.

They follow from the derivatives of its position and rotation, else from central differences of its poses.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import FROM_TYPE, MOTION_TYPE, inward, turn


@lean_inlined
def carried(floats, ints, at, pose, x, y, z):
    """The place of a point fixed to the object in its pose BEFORE or AFTER."""
    a, b, c = inward(floats, ints, at, x, y, z)
    a, b, c = turn(floats, ints[at + pose + 1], a, b, c)
    p = ints[at + pose]
    return a + floats[p], b + floats[p + 1], c + floats[p + 2]


@lean_inlined
def spin(floats, at, rotation):
    """2 q' q* without its scalar part [1/s]: of the derivative q' at floats[rotation:] of the quaternion at floats[at:]
    the angular velocity, of the second derivative the angular acceleration."""
    w, a, b, c = floats[at], floats[at + 1], floats[at + 2], floats[at + 3]
    s, x, y, z = floats[rotation], floats[rotation + 1], floats[rotation + 2], floats[rotation + 3]
    p = w * x - s * a - (y * c - z * b)
    q = w * y - s * b - (z * a - x * c)
    r = w * z - s * c - (x * b - y * a)
    return 2.0 * p, 2.0 * q, 2.0 * r


@lean_inlined
def about(wx, wy, wz, x, y, z):
    """The cross product w x r."""
    return wy * z - wz * y, wz * x - wx * z, wx * y - wy * x


@lean(MOTION_TYPE, inner=True)
def moving_velocity(floats, ints, at, x, y, z):
    """Velocity [m/s] of the point at (x, y, z) of a moving object."""
    apart = floats[ints[at + layout.MOVING]]
    if apart == 0.0:
        p, v = ints[at + layout.PLACE], ints[at + layout.BEFORE]
        wx, wy, wz = spin(floats, ints[at + layout.ROTATION], ints[at + layout.BEFORE + 1])
        a, b, c = about(wx, wy, wz, x - floats[p], y - floats[p + 1], z - floats[p + 2])
        return floats[v] + a, floats[v + 1] + b, floats[v + 2] + c
    a, b, c = carried(floats, ints, at, layout.BEFORE, x, y, z)
    p, q, r = carried(floats, ints, at, layout.AFTER, x, y, z)
    return (p - a) / (2.0 * apart), (q - b) / (2.0 * apart), (r - c) / (2.0 * apart)


@lean(MOTION_TYPE, inner=True)
def moving_acceleration(floats, ints, at, x, y, z):
    """Acceleration [m/s^2] of the point at (x, y, z) of a moving object."""
    apart = floats[ints[at + layout.MOVING]]
    if apart == 0.0:
        p, v = ints[at + layout.PLACE], ints[at + layout.AFTER]
        x, y, z = x - floats[p], y - floats[p + 1], z - floats[p + 2]
        wx, wy, wz = spin(floats, ints[at + layout.ROTATION], ints[at + layout.BEFORE + 1])
        a, b, c = about(wx, wy, wz, x, y, z)
        a, b, c = about(wx, wy, wz, a, b, c)
        wx, wy, wz = spin(floats, ints[at + layout.ROTATION], ints[at + layout.AFTER + 1])
        d, e, f = about(wx, wy, wz, x, y, z)
        return floats[v] + a + d, floats[v + 1] + b + e, floats[v + 2] + c + f
    a, b, c = carried(floats, ints, at, layout.BEFORE, x, y, z)
    p, q, r = carried(floats, ints, at, layout.AFTER, x, y, z)
    square = apart * apart
    return (p - 2.0 * x + a) / square, (q - 2.0 * y + b) / square, (r - 2.0 * z + c) / square


@lean(FROM_TYPE, inner=True)
def from_object(floats, ints, at, path):
    """Change a path (body_path_kernels) to the frame of a moving object, in its pose at the path's end.

    Returns a bound of the error [m]: half the object's acceleration at either end times the square of the duration.
    """
    h = path[12]
    most = 0.0
    for end in range(0, 12, 6):
        x, y, z = path[end], path[end + 1], path[end + 2]
        a, b, c = moving_acceleration(floats, ints, at, x, y, z)
        most = max(most, math.sqrt(a * a + b * b + c * c))
        u, v, w = moving_velocity(floats, ints, at, x, y, z)
        p, q, r = path[end + 3] - u, path[end + 4] - v, path[end + 5] - w
        if end == 0:
            # The object's rotation up to the end rotates the velocity, too.
            a, b, c = moving_velocity(floats, ints, at, x + p, y + q, z + r)
            p, q, r = p + h * (a - u), q + h * (b - v), r + h * (c - w)
            path[0], path[1], path[2] = x + h * u, y + h * v, z + h * w
        path[end + 3], path[end + 4], path[end + 5] = p, q, r
    return 0.5 * most * h * h
