# mypy: ignore-errors
"""The derivatives of forces at places of bodies (system.Place) by how the bodies move, by the chain rule.

A place moves by the numbers of its body: position, quaternion, velocity and angular momentum. Of a place with no arm
the quaternion and the momentum move nothing, and the force there turns nothing.
"""

import numpy as np

from sceneql.bodies.rigid.place_kernels import (
    ARM_AT,
    INERTIA_AT,
    INVERSE_AT,
    MOMENTUM_AT,
    ROTATION_AT,
    arm,
)
from sceneql.bodies.rigid.rigid_kernels import body_spin, times_symmetric, to_body, to_world
from sceneql.compiled.kernels import inlined

X, Q, V, L, COLUMNS = 0, 3, 7, 10, 13
"""Columns: position, quaternion, velocity, angular momentum of a body."""
ROWS = 6
"""Rows of a force: those of its body's velocity and angular momentum; of a place's motion: position and velocity."""


@inlined
def cross_into(out, row, column, ax, ay, az, bx, by, bz):
    """Add a vector product to three rows of a column."""
    out[row, column] += ay * bz - az * by
    out[row + 1, column] += az * bx - ax * bz
    out[row + 2, column] += ax * by - ay * bx


@inlined
def moved_by(y, floats, ints, at, out):
    """Write the derivatives (ROWS, COLUMNS) of the motion of the place of ints[at:]."""
    out[:, :] = 0.0
    for c in range(3):
        out[c, X + c] = out[3 + c, V + c] = 1.0
    if ints[at + ARM_AT] < 0:
        return
    q, momentum, inertia = ints[at + ROTATION_AT], ints[at + MOMENTUM_AT], ints[at + INERTIA_AT]
    rx, ry, rz = arm(y, floats, ints, at)
    wx, wy, wz = to_world(y, q, *body_spin(y, floats, q, momentum, inertia))
    _sx, _sy, _sz = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
    lx, ly, lz = y[momentum], y[momentum + 1], y[momentum + 2]
    a, b, c, d = y[q], y[q + 1], y[q + 2], y[q + 3]
    scale = 2.0 / (a * a + b * b + c * c + d * d)
    for k in range(4):
        # A change e of q turns the body by the vector part of 2 e conj(q) / |q|^2.
        ea, eb, ec, ed = 1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2), 1.0 * (k == 3)
        tx, ty = scale * (eb * a - ea * b + ed * c - ec * d), scale * (ec * a - ea * c + eb * d - ed * b)
        tz = scale * (ed * a - ea * d + ec * b - eb * c)
        cross_into(out, 0, Q + k, tx, ty, tz, rx, ry, rz)
        # w = I^-1 L, where I turns with the body: dw = t x w - I^-1 (t x L).
        gx, gy, gz = ty * lz - tz * ly, tz * lx - tx * lz, tx * ly - ty * lx
        ux, uy, uz = to_world(y, q, *times_symmetric(floats, inertia, *to_body(y, q, gx, gy, gz)))
        ux, uy, uz = ty * wz - tz * wy - ux, tz * wx - tx * wz - uy, tx * wy - ty * wx - uz
        cross_into(out, 3, Q + k, ux, uy, uz, rx, ry, rz)
        cross_into(out, 3, Q + k, wx, wy, wz, ty * rz - tz * ry, tz * rx - tx * rz, tx * ry - ty * rx)
    for k in range(3):
        ex, ey, ez = to_body(y, q, 1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2))
        ux, uy, uz = to_world(y, q, *times_symmetric(floats, inertia, ex, ey, ez))
        cross_into(out, 3, L + k, ux, uy, uz, rx, ry, rz)


@inlined
def add_force_slopes(y, floats, ints, at, by, moved, own, force, entries, first):
    """Add to entries[first:], ROWS x COLUMNS, the derivatives of a force (3,) at the place of ints[at:].

    ``by`` (3, 6): its derivatives by the motion of a place, that moves by ``moved``; ``own``: whether that is this one.
    """
    rx, ry, rz = arm(y, floats, ints, at)
    for k in range(COLUMNS):
        fx = fy = fz = 0.0
        for j in range(6):
            fx += by[0, j] * moved[j, k]
            fy += by[1, j] * moved[j, k]
            fz += by[2, j] * moved[j, k]
        e = first + k
        entries[e] += fx
        entries[e + COLUMNS] += fy
        entries[e + 2 * COLUMNS] += fz
        if ints[at + ARM_AT] < 0 or floats[ints[at + INVERSE_AT]] == 0.0:
            continue  # nothing turns, or the body is fixed
        tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
        if own and Q <= k < V:
            mx, my, mz = moved[0, k], moved[1, k], moved[2, k]
            tx += my * force[2] - mz * force[1]
            ty += mz * force[0] - mx * force[2]
            tz += mx * force[1] - my * force[0]
        entries[e + 3 * COLUMNS] += tx
        entries[e + 4 * COLUMNS] += ty
        entries[e + 5 * COLUMNS] += tz


@inlined
def add_at_one(y, floats, ints, at, fx, fy, fz, slopes, entries):
    """Add the derivatives of a force at one place; ``slopes``: those by its place and velocity, (3, 6) row by row."""
    by, moved = np.zeros((3, 6)), np.zeros((ROWS, COLUMNS))
    for i in range(3):
        for j in range(6):
            by[i, j] = slopes[6 * i + j]
    moved_by(y, floats, ints, at, moved)
    add_force_slopes(y, floats, ints, at, by, moved, True, (fx, fy, fz), entries, 0)


@inlined
def add_torque(y, floats, ints, at, tx, ty, tz, slopes, entries):
    """Add the derivatives (3 x 6, row by row) of a torque by place and velocity of its body's center."""
    for k in range(18):
        entries[k] += slopes[k]
