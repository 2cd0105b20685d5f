# mypy: ignore-errors
"""The rows of ties: what two bodies must keep to, its derivative by their motion, and what it asks of accelerations.

A row is one condition C = 0 between two movers a and b. With v the velocities and angular velocities of both,
dC/dt = J v, and C'' = J v' + bias. Conditions, with r fixed places and u, n, w fixed directions in a body's axes:

    POINT      n_b . (x_a + r_a - x_b - r_b)
    ANGLE      u_a . w_b - c
    DISTANCE   |x_a + r_a - x_b - r_b| - c
    GEAR       (c_a A + c_b B) / (|c_a| + |c_b|), A the angle of a about an axis of the world, B that of b; up to turns
"""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import times_symmetric
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A, I, N

POINT, ANGLE, DISTANCE, GEAR = range(4)
"""Kinds of rows; their numbers: r_a, r_b, n; u, w, c; r_a, r_b, c; of a axis, direction across it at the start, that
direction in its axes, the same of b, c_a, c_b."""

POSITION, VELOCITY, INVERSE, ROTATION, MOMENTUM, INERTIA = range(6)
PLACE, TURN, SPEED, SPIN, PUSH, TWIST, MOVER = range(6, 13)
"""Integers of a mover. One that is solved: offsets of position and velocity in y, of the inverse mass, of quaternion
and angular momentum in y, of the inverse inertia (-1: a mass). One that is led: offsets in the floats of its position,
quaternion, velocity, angular velocity, acceleration and angular acceleration. The world: -1 throughout."""

AT_X, AT_V, AT_R, AT_W, AT_INVERSE, AT_MASS, AT_A, AT_TWIST = 0, 3, 6, 15, 18, 27, 28, 31
AT_IMPULSE, AT_PUSHED, MOVED = 34, 40, 46
"""Floats of a mover: position, velocity, rotation (3, 3), angular velocity, inverse inertia in the world's axes (3, 3),
inverse mass; acceleration and angular acceleration, by all forces but the ties' and then with these; of ties, what the
last correction adds to force and torque, and these in all."""

AT_J, AT_BIAS, AT_C, AT_SPEED, AT_FORCE, AT_SIZE, AT_PUSH, AT_OPEN, ROW = 0, 12, 13, 14, 15, 16, 17, 18, 19
"""Floats of a row: J, by velocity and angular velocity of a, then of b; the bias, C, dC/dt, the force of the row; the
size of the numbers that C is the difference of; the force by which it answers contacts and drives, that are found by
the step (tied_step_kernels); the largest gap that was not closed at the end of a step."""

KIND, FIRST, SECOND, NUMBERS, SCRATCH, HOLDS, ROW_INTS = range(7)
"""Integers of a row: kind, both movers, offsets of its numbers, its floats, and of whether it holds (0: broken)."""


@lean_inlined
def cross(ax, ay, az, bx, by, bz):
    """The vector product."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@lean_inlined
def turned(floats, at, x, y, z):
    """The 3x3 matrix at floats[at:] times a vector."""
    return (
        floats[at] * x + floats[at + 1] * y + floats[at + 2] * z,
        floats[at + 3] * x + floats[at + 4] * y + floats[at + 5] * z,
        floats[at + 6] * x + floats[at + 7] * y + floats[at + 8] * z,
    )


@lean_inlined
def weighed(floats, mover, j):
    """The accelerations of a mover by the force floats[j:] and the torque behind it, (6,)."""
    inverse = floats[mover + AT_MASS]
    x, y, z = turned(floats, mover + AT_INVERSE, floats[j + 3], floats[j + 4], floats[j + 5])
    return inverse * floats[j], inverse * floats[j + 1], inverse * floats[j + 2], x, y, z


@lean_inlined
def put(floats, at, x, y, z):
    """Write a vector."""
    floats[at], floats[at + 1], floats[at + 2] = x, y, z


@lean_inlined
def write_turn(source, q, floats, to):
    """Write the rotation matrix of the quaternion at source[q:], of any length but 0, to floats[to:]."""
    a, b, c, d = source[q], source[q + 1], source[q + 2], source[q + 3]
    s = 2.0 / (a * a + b * b + c * c + d * d)
    put(floats, to, 1.0 - s * (c * c + d * d), s * (b * c - a * d), s * (b * d + a * c))
    put(floats, to + 3, s * (b * c + a * d), 1.0 - s * (b * b + d * d), s * (c * d - a * b))
    put(floats, to + 6, s * (b * d - a * c), s * (c * d + a * b), 1.0 - s * (b * b + c * c))


@lean_inlined
def write_inverse(floats, to, inertia):
    """Write the inverse inertia at floats[inertia:], in a mover's axes, in the world's: R G R^T."""
    r, own = to + AT_R, to + AT_INVERSE
    ax, ay, az = times_symmetric(floats, inertia, floats[r], floats[r + 1], floats[r + 2])
    bx, by, bz = times_symmetric(floats, inertia, floats[r + 3], floats[r + 4], floats[r + 5])
    cx, cy, cz = times_symmetric(floats, inertia, floats[r + 6], floats[r + 7], floats[r + 8])
    xx, yx, zx = turned(floats, r, ax, ay, az)
    _, yy, zy = turned(floats, r, bx, by, bz)
    _, _, zz = turned(floats, r, cx, cy, cz)
    put(floats, own, xx, yx, zx)
    put(floats, own + 3, yx, yy, zy)
    put(floats, own + 6, zx, zy, zz)


@lean(types.void(A, A, N, I, N))
def see(y, floats, to, ints, at):
    """Write the place and the motion of the mover of ints[at:] to floats[to:]."""
    for k in range(MOVED):
        floats[to + k] = 0.0
    x, led = ints[at + POSITION], ints[at + PLACE]
    if x >= 0:
        v = ints[at + VELOCITY]
        put(floats, to + AT_X, y[x], y[x + 1], y[x + 2])
        put(floats, to + AT_V, y[v], y[v + 1], y[v + 2])
        floats[to + AT_MASS] = floats[ints[at + INVERSE]]
    elif led >= 0:
        v, w = ints[at + SPEED], ints[at + SPIN]
        put(floats, to + AT_X, floats[led], floats[led + 1], floats[led + 2])
        put(floats, to + AT_V, floats[v], floats[v + 1], floats[v + 2])
        put(floats, to + AT_W, floats[w], floats[w + 1], floats[w + 2])
    q, turn = ints[at + ROTATION], ints[at + TURN]
    if x >= 0 and q >= 0:
        write_turn(y, q, floats, to + AT_R)
    elif led >= 0:
        write_turn(floats, turn, floats, to + AT_R)
    else:
        floats[to + AT_R] = floats[to + AT_R + 4] = floats[to + AT_R + 8] = 1.0
    if x >= 0 and q >= 0:
        momentum = ints[at + MOMENTUM]
        write_inverse(floats, to, ints[at + INERTIA])
        w = turned(floats, to + AT_INVERSE, y[momentum], y[momentum + 1], y[momentum + 2])
        put(floats, to + AT_W, *w)


@lean(types.void(A, A, A, N, I, N))
def press(y, rate, floats, to, ints, at):
    """Write the accelerations of the mover of ints[at:], by the forces in `rate`, behind what `see` wrote."""
    x, led, q = ints[at + POSITION], ints[at + PLACE], ints[at + ROTATION]
    if x >= 0:
        v, inverse = ints[at + VELOCITY], floats[to + AT_MASS]
        put(floats, to + AT_A, inverse * rate[v], inverse * rate[v + 1], inverse * rate[v + 2])
        if q >= 0:
            k, w = ints[at + MOMENTUM], to + AT_W
            # dL/dt = torque, and L = I w: I w' = torque - w x L.
            gx, gy, gz = cross(floats[w], floats[w + 1], floats[w + 2], y[k], y[k + 1], y[k + 2])
            turn = turned(floats, to + AT_INVERSE, rate[k] - gx, rate[k + 1] - gy, rate[k + 2] - gz)
            put(floats, to + AT_TWIST, *turn)
    elif led >= 0:
        a, b = ints[at + PUSH], ints[at + TWIST]
        put(floats, to + AT_A, floats[a], floats[a + 1], floats[a + 2])
        put(floats, to + AT_TWIST, floats[b], floats[b + 1], floats[b + 2])


@lean_inlined
def times_inertia(floats, mover, x, y, z):
    """The inertia of a mover that turns, in the world's axes, times a vector: by the inverse of its inverse."""
    g = mover + AT_INVERSE
    xx, yy, zz = floats[g], floats[g + 4], floats[g + 8]
    xy, xz, yz = floats[g + 1], floats[g + 2], floats[g + 5]
    ax, ay, az = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    by, bz, cz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    scale = 1.0 / (xx * ax + xy * ay + xz * az)
    return (
        scale * (ax * x + ay * y + az * z),
        scale * (ay * x + by * y + bz * z),
        scale * (az * x + bz * y + cz * z),
    )


@lean_inlined
def turning(y, floats, mover, momentum):
    """The rate of a mover's angular momentum, at its angular acceleration: I w' + w x L."""
    w, twist = mover + AT_W, mover + AT_TWIST
    mx, my, mz = cross(floats[w], floats[w + 1], floats[w + 2], y[momentum], y[momentum + 1], y[momentum + 2])
    tx, ty, tz = times_inertia(floats, mover, floats[twist], floats[twist + 1], floats[twist + 2])
    return tx + mx, ty + my, tz + mz


@lean_inlined
def arm(floats, mover, at):
    """A place r at floats[at:], in a mover's axes, in the world's; and w x r and w x (w x r) of the mover's spin."""
    rx, ry, rz = turned(floats, mover + AT_R, floats[at], floats[at + 1], floats[at + 2])
    wx, wy, wz = floats[mover + AT_W], floats[mover + AT_W + 1], floats[mover + AT_W + 2]
    sx, sy, sz = cross(wx, wy, wz, rx, ry, rz)
    cx, cy, cz = cross(wx, wy, wz, sx, sy, sz)
    return rx, ry, rz, sx, sy, sz, cx, cy, cz


@lean(types.void(A, I, N, N, N))
def write_row(floats, ints, at, a, b):
    """Write the row of ints[at:] between the movers whose floats begin at a and b."""
    kind, own, to = ints[at + KIND], ints[at + NUMBERS], ints[at + SCRATCH]
    if floats[ints[at + HOLDS]] == 0.0:
        for k in range(ROW):
            floats[to + k] = 0.0
        floats[to + AT_SIZE] = 1.0
        return
    ax, ay, az = floats[a + AT_W], floats[a + AT_W + 1], floats[a + AT_W + 2]
    bx, by, bz = floats[b + AT_W], floats[b + AT_W + 1], floats[b + AT_W + 2]
    if kind == GEAR:
        for k in range(12):
            floats[to + AT_J + k] = 0.0
        total = speed = 0.0
        size = abs(floats[own + 18]) + abs(floats[own + 19])
        for side in range(2):
            mover, at_side, part = (b, own + 9, floats[own + 19]) if side == 1 else (a, own, floats[own + 18])
            nx, ny, nz = floats[at_side], floats[at_side + 1], floats[at_side + 2]
            ex, ey, ez = floats[at_side + 3], floats[at_side + 4], floats[at_side + 5]
            ux, uy, uz = turned(floats, mover + AT_R, floats[at_side + 6], floats[at_side + 7], floats[at_side + 8])
            sx, sy, sz = cross(ex, ey, ez, ux, uy, uz)
            total += part * math.atan2(nx * sx + ny * sy + nz * sz, ex * ux + ey * uy + ez * uz)
            part /= size
            speed += part * (nx * floats[mover + AT_W] + ny * floats[mover + AT_W + 1] + nz * floats[mover + AT_W + 2])
            put(floats, to + AT_J + 6 * side + 3, part * nx, part * ny, part * nz)
        total -= 2.0 * math.pi * math.floor(total / (2.0 * math.pi) + 0.5)
        floats[to + AT_C] = total / size
        floats[to + AT_SPEED], floats[to + AT_BIAS], floats[to + AT_SIZE] = speed, 0.0, 1.0
        return
    if kind == ANGLE:
        ux, uy, uz, px, py, pz, ex, ey, ez = arm(floats, a, own)
        wx, wy, wz, qx, qy, qz, fx, fy, fz = arm(floats, b, own + 3)
        jx, jy, jz = cross(ux, uy, uz, wx, wy, wz)
        for k in range(12):
            floats[to + AT_J + k] = 0.0
        put(floats, to + AT_J + 3, jx, jy, jz)
        put(floats, to + AT_J + 9, -jx, -jy, -jz)
        floats[to + AT_C] = ux * wx + uy * wy + uz * wz - floats[own + 6]
        floats[to + AT_SPEED] = jx * (ax - bx) + jy * (ay - by) + jz * (az - bz)
        bias = ex * wx + ey * wy + ez * wz + ux * fx + uy * fy + uz * fz
        floats[to + AT_BIAS] = bias + 2.0 * (px * qx + py * qy + pz * qz)
        floats[to + AT_SIZE] = 1.0
        return
    rx, ry, rz, px, py, pz, ex, ey, ez = arm(floats, a, own)
    sx, sy, sz, qx, qy, qz, fx, fy, fz = arm(floats, b, own + 3)
    dx = floats[a + AT_X] + rx - floats[b + AT_X] - sx
    dy = floats[a + AT_X + 1] + ry - floats[b + AT_X + 1] - sy
    dz = floats[a + AT_X + 2] + rz - floats[b + AT_X + 2] - sz
    vx = floats[a + AT_V] + px - floats[b + AT_V] - qx
    vy = floats[a + AT_V + 1] + py - floats[b + AT_V + 1] - qy
    vz = floats[a + AT_V + 2] + pz - floats[b + AT_V + 2] - qz
    ex, ey, ez = ex - fx, ey - fy, ez - fz
    size = abs(rx) + abs(ry) + abs(rz) + abs(sx) + abs(sy) + abs(sz)
    for k in range(3):
        size += abs(floats[a + AT_X + k]) + abs(floats[b + AT_X + k])
    floats[to + AT_SIZE] = size
    if kind == DISTANCE:
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        inverse = 1.0 / length if length > 0.0 else 0.0
        nx, ny, nz = dx * inverse, dy * inverse, dz * inverse
        along = nx * vx + ny * vy + nz * vz
        floats[to + AT_C] = length - floats[own + 6]
        floats[to + AT_SPEED] = along
        across = (vx * vx + vy * vy + vz * vz - along * along) * inverse
        floats[to + AT_BIAS] = nx * ex + ny * ey + nz * ez + across
        gx, gy, gz = cross(sx, sy, sz, nx, ny, nz)
    else:
        nx, ny, nz, mx, my, mz, gx, gy, gz = arm(floats, b, own + 6)
        floats[to + AT_C] = nx * dx + ny * dy + nz * dz
        floats[to + AT_SPEED] = nx * vx + ny * vy + nz * vz + mx * dx + my * dy + mz * dz
        bias = nx * ex + ny * ey + nz * ez + gx * dx + gy * dy + gz * dz
        floats[to + AT_BIAS] = bias + 2.0 * (mx * vx + my * vy + mz * vz)
        gx, gy, gz = cross(sx + dx, sy + dy, sz + dz, nx, ny, nz)
    put(floats, to + AT_J, nx, ny, nz)
    put(floats, to + AT_J + 3, *cross(rx, ry, rz, nx, ny, nz))
    put(floats, to + AT_J + 6, -nx, -ny, -nz)
    put(floats, to + AT_J + 9, -gx, -gy, -gz)
