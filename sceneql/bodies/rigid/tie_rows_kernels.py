# mypy: ignore-errors
"""The rows of ties: what two bodies must keep to, its derivative by their motion, and what it asks of accelerations.

A row is one condition C = 0 between two movers a and b. With v the velocities and angular velocities of both,
dC/dt = J v, and C'' = J v' + bias. Conditions, with r fixed places and u, n, w fixed directions in a body's axes:

    POINT      n_b . (x_a + r_a - x_b - r_b)
    ANGLE      u_a . w_b - c
    DISTANCE   |x_a + r_a - x_b - r_b| - c
    GEAR       (c_a (A - P) + c_b (B - P)) / (|c_a| + |c_b|), up to turns: A the angle of a about an axis of the world,
               B that of b, P that of the line from the axle of a to that of b, or 0
    CARRIED    (c_a A + c_b B) / (|c_a| + |c_b|), up to turns: A the angle of a about an axis n_a that it carries with
               it, against the line from its axle to that of b, or against n_b; B that of b about n_b, against the same
               line, or against n_a. So both count against what their axles are in, wherever that turns to.
"""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import times_symmetric
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.system.signatures_kernels import A, I, N

write_gear = lazy("sceneql.bodies.gears.gear_kernels:write_gear", types.void(A, A, A, A))
write_carried = lazy("sceneql.bodies.gears.carried_gear_kernels:write_carried", types.void(A, A, A, A))

POINT, ANGLE, DISTANCE, GEAR, BALL, WRITTEN, CARRIED = range(7)
"""Kinds of rows; their numbers: r_a, r_b, n; u, w, c; r_a, r_b, c; of a axis, direction across it at the start, that
direction in its axes, the same of b, r_a, r_b of the axles, the line between them at the start, c_a, c_b, the line's
length (0: P is 0); r_a, r_b. WRITTEN are the second and third of a BALL. Of CARRIED: n_a, n_b, what they count from at
the start, across them, a's and b's; r_a, r_b of the axles, c_a, c_b, the line's length (0: against the axes)."""
MOST_NUMBERS, AXLES, LINE, TEETH, LENGTH = 30, 18, 24, 27, 29
"""Most numbers of a row; where those of a GEAR are that tell of its line, and c_a."""
OF_ARMS, OF_TEETH, OF_LINE = 12, 18, 20
"""Where the numbers of a CARRIED are that tell of its axles, of c_a, and of the line's length."""

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
    return weighed_by(floats[mover : mover + MOVED], floats[j : j + 6])


@lean_inlined
def weighed_by(m, six):
    """The accelerations of a mover by a force and the torque behind it, (6,)."""
    inverse = m[AT_MASS]
    x, y, z = turned(m, AT_INVERSE, six[3], six[4], six[5])
    return inverse * six[0], inverse * six[1], inverse * six[2], x, y, z


@lean_inlined
def put(floats, at, x, y, z):
    """Write a vector."""
    floats[at], floats[at + 1], floats[at + 2] = x, y, z


@lean_inlined
def write_turn(source, q, m):
    """Write the rotation matrix of the quaternion at source[q:], of any length but 0, to a mover's floats."""
    four = source[q : q + 4]
    a, b, c, d = four[0], four[1], four[2], four[3]
    s = 2.0 / (a * a + b * b + c * c + d * d)
    put(m, AT_R, 1.0 - s * (c * c + d * d), s * (b * c - a * d), s * (b * d + a * c))
    put(m, AT_R + 3, s * (b * c + a * d), 1.0 - s * (b * b + d * d), s * (c * d - a * b))
    put(m, AT_R + 6, s * (b * d - a * c), s * (c * d + a * b), 1.0 - s * (b * b + c * c))


@lean_inlined
def write_inverse(m, own):
    """Write an inverse inertia (6,) in a mover's axes to the mover's floats, in the world's: R G R^T."""
    r = AT_R
    ax, ay, az = times_symmetric(own, 0, m[r], m[r + 1], m[r + 2])
    bx, by, bz = times_symmetric(own, 0, m[r + 3], m[r + 4], m[r + 5])
    cx, cy, cz = times_symmetric(own, 0, m[r + 6], m[r + 7], m[r + 8])
    xx, yx, zx = turned(m, r, ax, ay, az)
    _, yy, zy = turned(m, r, bx, by, bz)
    _, _, zz = turned(m, r, cx, cy, cz)
    put(m, AT_INVERSE, xx, yx, zx)
    put(m, AT_INVERSE + 3, yx, yy, zy)
    put(m, AT_INVERSE + 6, zx, zy, zz)


@lean(types.void(A, A, N, I, N))
def see(y, floats, to, ints, at):
    """Write the place and the motion of the mover of ints[at:] to floats[to:]."""
    # Slices, here and below, since an index into one need not be asked whether it counts from the end.
    m, which = floats[to : to + MOVED], ints[at : at + MOVER]
    for k in range(MOVED):
        m[k] = 0.0
    x, q, led = which[POSITION], which[ROTATION], which[PLACE]
    if x >= 0:
        place, velocity = y[x : x + 3], y[which[VELOCITY] : which[VELOCITY] + 3]
        put(m, AT_X, place[0], place[1], place[2])
        put(m, AT_V, velocity[0], velocity[1], velocity[2])
        m[AT_MASS] = floats[which[INVERSE]]
        if q >= 0:
            momentum = y[which[MOMENTUM] : which[MOMENTUM] + 3]
            write_turn(y, q, m)
            write_inverse(m, floats[which[INERTIA] : which[INERTIA] + 6])
            put(m, AT_W, *turned(m, AT_INVERSE, momentum[0], momentum[1], momentum[2]))
            return
    elif led >= 0:
        v, w = which[SPEED], which[SPIN]
        put(m, AT_X, floats[led], floats[led + 1], floats[led + 2])
        put(m, AT_V, floats[v], floats[v + 1], floats[v + 2])
        put(m, AT_W, floats[w], floats[w + 1], floats[w + 2])
        write_turn(floats, which[TURN], m)
        return
    m[AT_R] = m[AT_R + 4] = m[AT_R + 8] = 1.0


@lean(types.void(A, A, A, N, I, N))
def press(y, rate, floats, to, ints, at):
    """Write the accelerations of the mover of ints[at:], by the forces in `rate`, behind what `see` wrote."""
    m, which = floats[to : to + MOVED], ints[at : at + MOVER]
    x, led, q = which[POSITION], which[PLACE], which[ROTATION]
    if x >= 0:
        force, inverse = rate[which[VELOCITY] : which[VELOCITY] + 3], m[AT_MASS]
        put(m, AT_A, inverse * force[0], inverse * force[1], inverse * force[2])
        if q >= 0:
            k = which[MOMENTUM]
            momentum, torque = y[k : k + 3], rate[k : k + 3]
            # dL/dt = torque, and L = I w: I w' = torque - w x L.
            gx, gy, gz = cross(m[AT_W], m[AT_W + 1], m[AT_W + 2], momentum[0], momentum[1], momentum[2])
            put(m, AT_TWIST, *turned(m, AT_INVERSE, torque[0] - gx, torque[1] - gy, torque[2] - gz))
    elif led >= 0:
        a, b = which[PUSH], which[TWIST]
        put(m, AT_A, floats[a], floats[a + 1], floats[a + 2])
        put(m, AT_TWIST, floats[b], floats[b + 1], floats[b + 2])


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
def arm(m, own, at):
    """A place r at own[at:], in a mover's axes, in the world's; and w x r and w x (w x r) of the mover's spin."""
    rx, ry, rz = turned(m, AT_R, own[at], own[at + 1], own[at + 2])
    wx, wy, wz = m[AT_W], m[AT_W + 1], m[AT_W + 2]
    sx, sy, sz = cross(wx, wy, wz, rx, ry, rz)
    cx, cy, cz = cross(wx, wy, wz, sx, sy, sz)
    return rx, ry, rz, sx, sy, sz, cx, cy, cz


@lean_inlined
def write_angle(a, b, own, row):
    """Write the row of an ANGLE between two movers."""
    ux, uy, uz, px, py, pz, ex, ey, ez = arm(a, own, 0)
    wx, wy, wz, qx, qy, qz, fx, fy, fz = arm(b, own, 3)
    jx, jy, jz = cross(ux, uy, uz, wx, wy, wz)
    put(row, AT_J, 0.0, 0.0, 0.0)
    put(row, AT_J + 3, jx, jy, jz)
    put(row, AT_J + 6, 0.0, 0.0, 0.0)
    put(row, AT_J + 9, -jx, -jy, -jz)
    row[AT_C] = ux * wx + uy * wy + uz * wz - own[6]
    dx, dy, dz = a[AT_W] - b[AT_W], a[AT_W + 1] - b[AT_W + 1], a[AT_W + 2] - b[AT_W + 2]
    row[AT_SPEED] = jx * dx + jy * dy + jz * dz
    bias = ex * wx + ey * wy + ez * wz + ux * fx + uy * fy + uz * fz
    row[AT_BIAS] = bias + 2.0 * (px * qx + py * qy + pz * qz)
    row[AT_SIZE] = 1.0


@lean_inlined
def write_ball(rows, b, size, rx, ry, rz, sx, sy, sz, gap, speed, bend):
    """Write the three rows of a BALL: arms of its place at a, and of that at b; gap, its rate, and w x (w x r) of both.

    The components are those in b's axes, so that forces at an open joint, too, keep the angular momentum.
    """
    dx, dy, dz = gap
    vx, vy, vz = speed
    ex, ey, ez = bend
    wx, wy, wz = b[AT_W], b[AT_W + 1], b[AT_W + 2]
    px, py, pz = cross(wx, wy, wz, dx, dy, dz)
    qx, qy, qz = px - 2.0 * vx, py - 2.0 * vy, pz - 2.0 * vz
    vx, vy, vz = vx - px, vy - py, vz - pz
    px, py, pz = cross(wx, wy, wz, qx, qy, qz)
    ex, ey, ez = ex + px, ey + py, ez + pz
    sx, sy, sz = sx + dx, sy + dy, sz + dz
    for k in range(3):
        row = rows[ROW * k : ROW * (k + 1)]
        nx, ny, nz = b[AT_R + k], b[AT_R + 3 + k], b[AT_R + 6 + k]
        gx, gy, gz = cross(sx, sy, sz, nx, ny, nz)
        put(row, AT_J, nx, ny, nz)
        put(row, AT_J + 3, *cross(rx, ry, rz, nx, ny, nz))
        put(row, AT_J + 6, -nx, -ny, -nz)
        put(row, AT_J + 9, -gx, -gy, -gz)
        row[AT_BIAS] = nx * ex + ny * ey + nz * ez
        row[AT_C] = nx * dx + ny * dy + nz * dz
        row[AT_SPEED] = nx * vx + ny * vy + nz * vz
        row[AT_SIZE] = size


@lean_inlined
def write_row(floats, ints, at, a, b):
    """Write the row of ints[at:] between the movers whose floats begin at a and b."""
    which = ints[at : at + ROW_INTS]
    if which[KIND] != WRITTEN:
        write(floats, which[KIND], which[SCRATCH], which[NUMBERS], floats[which[HOLDS]] != 0.0, a, b)


@lean(types.void(A, N, N, N, types.boolean, N, N))
def write(floats, kind, to, numbers, holds, a, b):
    """Write a row to floats[to:], of BALL with the two behind it; all 0 if it does not hold."""
    rows = floats[to : to + (3 * ROW if kind == BALL else ROW)]
    if not holds:
        for k in range(rows.size):
            rows[k] = 0.0
        for k in range(0, rows.size, ROW):
            rows[k + AT_SIZE] = 1.0
        return
    one, two, own = floats[a : a + MOVED], floats[b : b + MOVED], floats[numbers : numbers + MOST_NUMBERS]
    if kind == GEAR:
        write_gear(one, two, own, rows)
        return
    if kind == CARRIED:
        write_carried(one, two, own, rows)
        return
    if kind == ANGLE:
        write_angle(one, two, own, rows)
        return
    rx, ry, rz, px, py, pz, ex, ey, ez = arm(one, own, 0)
    sx, sy, sz, qx, qy, qz, fx, fy, fz = arm(two, own, 3)
    dx = one[AT_X] + rx - two[AT_X] - sx
    dy = one[AT_X + 1] + ry - two[AT_X + 1] - sy
    dz = one[AT_X + 2] + rz - two[AT_X + 2] - sz
    vx = one[AT_V] + px - two[AT_V] - qx
    vy = one[AT_V + 1] + py - two[AT_V + 1] - qy
    vz = one[AT_V + 2] + pz - two[AT_V + 2] - qz
    ex, ey, ez = ex - fx, ey - fy, ez - fz
    size = abs(rx) + abs(ry) + abs(rz) + abs(sx) + abs(sy) + abs(sz)
    for k in range(3):
        size += abs(one[AT_X + k]) + abs(two[AT_X + k])
    if kind == BALL:
        write_ball(rows, two, size, rx, ry, rz, sx, sy, sz, (dx, dy, dz), (vx, vy, vz), (ex, ey, ez))
        return
    rows[AT_SIZE] = size
    if kind == DISTANCE:
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        inverse = 1.0 / length if length > 0.0 else 0.0
        nx, ny, nz = dx * inverse, dy * inverse, dz * inverse
        along = nx * vx + ny * vy + nz * vz
        rows[AT_C] = length - own[6]
        rows[AT_SPEED] = along
        across = (vx * vx + vy * vy + vz * vz - along * along) * inverse
        rows[AT_BIAS] = nx * ex + ny * ey + nz * ez + across
        gx, gy, gz = cross(sx, sy, sz, nx, ny, nz)
    else:
        nx, ny, nz, mx, my, mz, gx, gy, gz = arm(two, own, 6)
        rows[AT_C] = nx * dx + ny * dy + nz * dz
        rows[AT_SPEED] = nx * vx + ny * vy + nz * vz + mx * dx + my * dy + mz * dz
        bias = nx * ex + ny * ey + nz * ez + gx * dx + gy * dy + gz * dz
        rows[AT_BIAS] = bias + 2.0 * (mx * vx + my * vy + mz * vz)
        gx, gy, gz = cross(sx + dx, sy + dy, sz + dz, nx, ny, nz)
    put(rows, AT_J, nx, ny, nz)
    put(rows, AT_J + 3, *cross(rx, ry, rz, nx, ny, nz))
    put(rows, AT_J + 6, -nx, -ny, -nz)
    put(rows, AT_J + 9, -gx, -gy, -gz)
