# mypy: ignore-errors
"""The surface of an object as contacts see it: four kernels of its shape, called by address, and its motion.

A shape's file has

    surface(floats, ints, at, x, y, z) -> d, nx, ny, nz   signed distance [m] of a point, > 0 outside, and the unit
                                    normal outwards there; a field that is no distance has to be one to first order
                                    near its surface
    bend(floats, ints, at, x, y, z, vx, vy, vz)   v . H v [m/s^2] with H the Hessian of the distance: the normal
                                    acceleration of a straight path relative to the surface
    clear(floats, ints, at, x, y, z, radius)   whether it is proved that no point of the object is within radius [m];
                                    called for bodies that come from outside
    near(floats, ints, at, h, x0, v0, x1, v1, radii, more, found)   sets found[k] to 1 for every body of radius
                                    radii[k] + more that is not proved clear on its cubic path in a time h from x0 with
                                    velocity v0 to x1, v1 (3 n,); without it `clear` is called for each body

An object is OBJECT integers at ints[at:]: the four addresses; offsets into the floats of position (3), rotation (4,
unit quaternion [w, x, y, z]), size (the shape's own) and depth (how deep a point can be inside, or less); of the
seconds between its poses (offset 0 if it never moves), and of position and rotation so much earlier and so much later,
whose central differences are velocities and accelerations, or where these seconds are 0, of the first and second
derivatives of position and rotation; 1 if it is a plane that never moves, which costs no call; and the place in ints of
further integers of the shape.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.contacts import layout
from sceneql.system.signatures_kernels import A, F, I, N

UNIT = 4e-16
"""Deviation from 1 of the square of a unit normal: an ulp or two."""

FOUR = types.UniTuple(F, 4)
THREE = types.UniTuple(F, 3)
MOTION_TYPE = THREE(A, I, N, F, F, F)
FROM_TYPE = F(A, I, N, A)
SURFACE_TYPE = FOUR(A, I, N, F, F, F)
BEND_TYPE = F(A, I, N, F, F, F, F, F, F)
CLEAR_TYPE = types.boolean(A, I, N, F, F, F, F)
NEAR_TYPE = types.void(A, I, N, F, A, A, A, A, A, F, A)

moving_velocity = lazy("sceneql.contacts.moving_kernels:moving_velocity", MOTION_TYPE)
moving_acceleration = lazy("sceneql.contacts.moving_kernels:moving_acceleration", MOTION_TYPE)
surface_at, bend_at, clear_at, near_at = (kernel_at(kind) for kind in (SURFACE_TYPE, BEND_TYPE, CLEAR_TYPE, NEAR_TYPE))


@lean_inlined
def turn(floats, at, x, y, z):
    """A vector rotated by the unit quaternion at floats[at:]."""
    w, a, b, c = floats[at], floats[at + 1], floats[at + 2], floats[at + 3]
    p = b * z - c * y + w * x
    q = c * x - a * z + w * y
    r = a * y - b * x + w * z
    return x + 2.0 * (b * r - c * q), y + 2.0 * (c * p - a * r), z + 2.0 * (a * q - b * p)


@lean_inlined
def facing(floats, ints, at, x, y, z):
    """Signed distance from a plane, and its normal."""
    place, size = ints[at + layout.PLACE], ints[at + layout.SIZE]
    a, b, c = floats[size], floats[size + 1], floats[size + 2]
    if floats[ints[at + layout.ROTATION]] != 1.0:
        a, b, c = turn(floats, ints[at + layout.ROTATION], a, b, c)
    square = a * a + b * b + c * c
    if abs(square - 1.0) > UNIT:
        scale = 1.0 / math.sqrt(square)
        a, b, c = a * scale, b * scale, c * scale
    return a * (x - floats[place]) + b * (y - floats[place + 1]) + c * (z - floats[place + 2]), a, b, c


@lean_inlined
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal of the object at ints[at:]."""
    if ints[at + layout.FLAT] != 0:
        return facing(floats, ints, at, x, y, z)
    return surface_at(ints[at + layout.SURFACE])(floats, ints, at, x, y, z)


@lean_inlined
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """v . H v [m/s^2] at the surface of the object at ints[at:]."""
    if ints[at + layout.FLAT] != 0:
        return 0.0
    return bend_at(ints[at + layout.BEND])(floats, ints, at, x, y, z, vx, vy, vz)


@lean_inlined
def clear(floats, ints, at, x, y, z, radius):
    """Whether it is proved that the object at ints[at:] has no point within a radius."""
    if ints[at + layout.FLAT] != 0:
        return facing(floats, ints, at, x, y, z)[0] > radius
    return clear_at(ints[at + layout.CLEAR])(floats, ints, at, x, y, z, radius)


@lean_inlined
def unturn(floats, at, x, y, z):
    """A vector rotated back."""
    w, a, b, c = floats[at], -floats[at + 1], -floats[at + 2], -floats[at + 3]
    p = b * z - c * y + w * x
    q = c * x - a * z + w * y
    r = a * y - b * x + w * z
    return x + 2.0 * (b * r - c * q), y + 2.0 * (c * p - a * r), z + 2.0 * (a * q - b * p)


@lean_inlined
def inward(floats, ints, at, x, y, z):
    """A point in the object's own coordinates."""
    p = ints[at + layout.PLACE]
    return unturn(floats, ints[at + layout.ROTATION], x - floats[p], y - floats[p + 1], z - floats[p + 2])


@lean_inlined
def velocity(floats, ints, at, x, y, z):
    """Velocity [m/s] of the object's own point at (x, y, z)."""
    if ints[at + layout.MOVING] == 0:
        return 0.0, 0.0, 0.0
    return moving_velocity(floats, ints, at, x, y, z)


@lean_inlined
def acceleration(floats, ints, at, x, y, z):
    """Acceleration [m/s^2] of the object's own point at (x, y, z)."""
    if ints[at + layout.MOVING] == 0:
        return 0.0, 0.0, 0.0
    return moving_acceleration(floats, ints, at, x, y, z)
