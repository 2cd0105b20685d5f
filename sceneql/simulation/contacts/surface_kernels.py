# mypy: ignore-errors
"""Surfaces that can be collided with: signed distance, normal, curvature and motion at a point.

An object is nine integers: shape, then offsets into the floats of its position (3), rotation (4, unit quaternion
[w, x, y, z]) and size; of the seconds between its poses, 0 if it never moves; of position and rotation so much earlier
and so much later. Velocities and accelerations of a moving object are central differences of its poses.
"""

import math

from numba import types

from sceneql.kernels import inlined, kernel
from sceneql.system_kernels import A, F, I, N

PLANE, SPHERE, BOX = 0, 1, 2
OBJECT = 9
MOVING = 4

FOUR = types.UniTuple(types.float64, 4)
THREE = types.UniTuple(types.float64, 3)


@inlined
def turn(floats, at, x, y, z):
    """A vector turned by the quaternion at floats[at:]."""
    w, a, b, c = floats[at], floats[at + 1], floats[at + 2], floats[at + 3]
    p = b * z - c * y + w * x
    q = c * x - a * z + w * y
    r = a * y - b * x + w * z
    return x + 2.0 * (b * r - c * q), y + 2.0 * (c * p - a * r), z + 2.0 * (a * q - b * p)


@inlined
def unturn(floats, at, x, y, z):
    """A vector turned back."""
    w, a, b, c = floats[at], -floats[at + 1], -floats[at + 2], -floats[at + 3]
    p = b * z - c * y + w * x
    q = c * x - a * z + w * y
    r = a * y - b * x + w * z
    return x + 2.0 * (b * r - c * q), y + 2.0 * (c * p - a * r), z + 2.0 * (a * q - b * p)


@inlined
def box_distance(floats, size_at, x, y, z):
    """Signed distance and local normal of a box of half sides floats[size_at:]."""
    ox = abs(x) - floats[size_at]
    oy = abs(y) - floats[size_at + 1]
    oz = abs(z) - floats[size_at + 2]
    sx = math.copysign(1.0, x)
    sy = math.copysign(1.0, y)
    sz = math.copysign(1.0, z)
    inside = max(ox, max(oy, oz))
    if inside <= 0.0:
        if inside == ox:
            return inside, sx, 0.0, 0.0
        if inside == oy:
            return inside, 0.0, sy, 0.0
        return inside, 0.0, 0.0, sz
    ox, oy, oz = max(ox, 0.0), max(oy, 0.0), max(oz, 0.0)
    d = math.sqrt(ox * ox + oy * oy + oz * oz)
    return d, sx * ox / d, sy * oy / d, sz * oz / d


@kernel(FOUR(A, I, N, F, F, F))
def surface(floats, ints, at, x, y, z):
    """Signed distance [m] of a point from the object at ints[at:], > 0 outside, and the unit normal outwards there."""
    position_at, rotation_at, size_at = ints[at + 1], ints[at + 2], ints[at + 3]
    x -= floats[position_at]
    y -= floats[position_at + 1]
    z -= floats[position_at + 2]
    if ints[at] == SPHERE:
        d = math.sqrt(x * x + y * y + z * z)
        if d == 0.0:
            return -floats[size_at], 0.0, 1.0, 0.0
        return d - floats[size_at], x / d, y / d, z / d
    if ints[at] == PLANE:
        a, b, c = turn(floats, rotation_at, floats[size_at], floats[size_at + 1], floats[size_at + 2])
        length = math.sqrt(a * a + b * b + c * c)
        a, b, c = a / length, b / length, c / length
        return a * x + b * y + c * z, a, b, c
    x, y, z = unturn(floats, rotation_at, x, y, z)
    d, a, b, c = box_distance(floats, size_at, x, y, z)
    a, b, c = turn(floats, rotation_at, a, b, c)
    return d, a, b, c


@kernel(types.float64(A, I, N, F, F, F, F, F, F))
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """v . H v [m/s^2] with H the second derivative of the distance: how fast a straight path leaves the surface.

    Outside it is (v^2 - (v.n)^2) / rho over the axes that are curved there, rho the distance from the nearest center
    of curvature.
    """
    position_at, rotation_at, size_at = ints[at + 1], ints[at + 2], ints[at + 3]
    x -= floats[position_at]
    y -= floats[position_at + 1]
    z -= floats[position_at + 2]
    if ints[at] == PLANE:
        return 0.0
    if ints[at] == BOX:
        x, y, z = unturn(floats, rotation_at, x, y, z)
        vx, vy, vz = unturn(floats, rotation_at, vx, vy, vz)
        x = math.copysign(max(abs(x) - floats[size_at], 0.0), x)
        y = math.copysign(max(abs(y) - floats[size_at + 1], 0.0), y)
        z = math.copysign(max(abs(z) - floats[size_at + 2], 0.0), z)
        vx = vx if x != 0.0 else 0.0
        vy = vy if y != 0.0 else 0.0
        vz = vz if z != 0.0 else 0.0
    rho = math.sqrt(x * x + y * y + z * z)
    if rho < 1e-12:
        return 0.0
    along = (vx * x + vy * y + vz * z) / rho
    return max(0.0, vx * vx + vy * vy + vz * vz - along * along) / rho


@kernel(types.float64(A, I, N))
def half_depth(floats, ints, at):
    """How deep [m] a point can be inside: a path shorter than that cannot cross the object unseen."""
    size_at = ints[at + 3]
    if ints[at] == PLANE:
        return math.inf
    if ints[at] == SPHERE:
        return floats[size_at]
    return min(floats[size_at], min(floats[size_at + 1], floats[size_at + 2]))


@inlined
def carried(floats, ints, at, pose, x, y, z):
    """Where a point that is fixed to the object stands a little earlier (pose 5) or later (pose 7)."""
    a, b, c = unturn(
        floats, ints[at + 2], x - floats[ints[at + 1]], y - floats[ints[at + 1] + 1], z - floats[ints[at + 1] + 2]
    )
    a, b, c = turn(floats, ints[at + pose + 1], a, b, c)
    position_at = ints[at + pose]
    return a + floats[position_at], b + floats[position_at + 1], c + floats[position_at + 2]


@kernel(THREE(A, I, N, F, F, F))
def velocity(floats, ints, at, x, y, z):
    """Velocity [m/s] of the object's own point at (x, y, z)."""
    if ints[at + MOVING] == 0:
        return 0.0, 0.0, 0.0
    apart = floats[ints[at + MOVING]]
    a, b, c = carried(floats, ints, at, 5, x, y, z)
    p, q, r = carried(floats, ints, at, 7, x, y, z)
    return (p - a) / (2.0 * apart), (q - b) / (2.0 * apart), (r - c) / (2.0 * apart)


@kernel(THREE(A, I, N, F, F, F))
def acceleration(floats, ints, at, x, y, z):
    """Acceleration [m/s^2] of the object's own point at (x, y, z)."""
    if ints[at + MOVING] == 0:
        return 0.0, 0.0, 0.0
    apart = floats[ints[at + MOVING]]
    a, b, c = carried(floats, ints, at, 5, x, y, z)
    p, q, r = carried(floats, ints, at, 7, x, y, z)
    square = apart * apart
    return (p - 2.0 * x + a) / square, (q - 2.0 * y + b) / square, (r - 2.0 * z + c) / square
