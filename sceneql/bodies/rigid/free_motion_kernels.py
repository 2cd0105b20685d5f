# mypy: ignore-errors
"""The free motion of rigid bodies: each turns with its angular momentum as it would without torque.

A body on a ball fixed in the world does so about that point, with its inertia and angular momentum about it.
"""

from sceneql.bodies.rigid.free_rotation_kernels import rotated
from sceneql.bodies.rigid.rigid_kernels import (
    COUNT,
    MOMENTUM_AT,
    PRINCIPAL_AT,
    ROTATION_AT,
    times_symmetric,
    to_body,
    to_world,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import FREE_MOTION

PLACE_AT, SPEED_AT, TURN_AT, OWN_AT, MASS_AT, ARM_AT, POINT_AT, ABOUT_AT, ABOUT_INVERSE_AT = range(9)
"""Integers of `pivot`: offsets of position, velocity, quaternion and angular momentum in y; in the floats, of the mass,
of the way from the point to the center of mass in the body's axes, of the point; of the principal moments and axes
about it, and of the inverse inertia about it."""


@lean_inlined
def product(a, b, c, d, e, f, g, h):
    """The product of two quaternions: the rotation by the second, then by the first."""
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g + c * e + d * f - b * h,
        a * h + d * e + b * g - c * f,
    )


@lean_inlined
def turn_by(h, y, q, x, y_, z, floats, at):
    """Turn the quaternion y[q:] over h [s] by an angular momentum; principal moments and axes are floats[at:]."""
    if floats[at] == 0.0 or (x == 0.0 and y_ == 0.0 and z == 0.0):
        return
    pa, pb, pc, pd = floats[at + 3], floats[at + 4], floats[at + 5], floats[at + 6]
    length = (y[q] ** 2 + y[q + 1] ** 2 + y[q + 2] ** 2 + y[q + 3] ** 2) ** 0.5
    a, b, c, d = product(y[q] / length, y[q + 1] / length, y[q + 2] / length, y[q + 3] / length, pa, pb, pc, pd)
    a, b, c, d = rotated(a, b, c, d, x, y_, z, floats[at], floats[at + 1], floats[at + 2], h)
    y[q], y[q + 1], y[q + 2], y[q + 3] = product(a, b, c, d, pa, -pb, -pc, -pd)


@lean(FREE_MOTION, inner=True)
def turn(h, y, floats, ints):
    """Turns every body by its exact free rotation over h [s]."""
    for k in range(ints[COUNT]):
        q, momentum, at = ints[ROTATION_AT] + 4 * k, ints[MOMENTUM_AT] + 3 * k, ints[PRINCIPAL_AT] + 7 * k
        turn_by(h, y, q, y[momentum], y[momentum + 1], y[momentum + 2], floats, at)


@lean(FREE_MOTION, inner=True)
def pivot(h, y, floats, ints):
    """Turns a body about a point of the world: its place, velocity and own momentum follow from the whole one."""
    x, v, q, momentum = ints[PLACE_AT], ints[SPEED_AT], ints[TURN_AT], ints[OWN_AT]
    k, mass = ints[ARM_AT], floats[ints[MASS_AT]]
    rx, ry, rz = to_world(y, q, floats[k], floats[k + 1], floats[k + 2])
    wx = y[momentum] + mass * (ry * y[v + 2] - rz * y[v + 1])
    wy = y[momentum + 1] + mass * (rz * y[v] - rx * y[v + 2])
    wz = y[momentum + 2] + mass * (rx * y[v + 1] - ry * y[v])
    turn_by(h, y, q, wx, wy, wz, floats, ints[ABOUT_AT])
    rx, ry, rz = to_world(y, q, floats[k], floats[k + 1], floats[k + 2])
    sx, sy, sz = to_world(y, q, *times_symmetric(floats, ints[ABOUT_INVERSE_AT], *to_body(y, q, wx, wy, wz)))
    p = ints[POINT_AT]
    for c, place, speed in ((0, rx, sy * rz - sz * ry), (1, ry, sz * rx - sx * rz), (2, rz, sx * ry - sy * rx)):
        y[x + c], y[v + c] = floats[p + c] + place, speed
    y[momentum] = wx - mass * (ry * y[v + 2] - rz * y[v + 1])
    y[momentum + 1] = wy - mass * (rz * y[v] - rx * y[v + 2])
    y[momentum + 2] = wz - mass * (rx * y[v + 1] - ry * y[v])
