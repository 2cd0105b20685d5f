# mypy: ignore-errors
"""The row of a gear whose wheels turn about axes that keep their directions in the world (tie_rows_kernels)."""

import math

from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import (
    AT_BIAS,
    AT_C,
    AT_J,
    AT_R,
    AT_SIZE,
    AT_SPEED,
    AT_V,
    AT_W,
    AT_X,
    AXLES,
    LENGTH,
    LINE,
    TEETH,
    arm,
    cross,
    put,
    turned,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A


@lean_inlined
def write_line(a, b, own, row, part):
    """Subtract from J that of the line of axles, times `part`; its angle, the rate of that, and the bias of that."""
    nx, ny, nz = own[0], own[1], own[2]
    rx, ry, rz, px, py, pz, ex, ey, ez = arm(a, own, AXLES)
    sx, sy, sz, qx, qy, qz, fx, fy, fz = arm(b, own, AXLES + 3)
    dx = b[AT_X] + sx - a[AT_X] - rx
    dy = b[AT_X + 1] + sy - a[AT_X + 1] - ry
    dz = b[AT_X + 2] + sz - a[AT_X + 2] - rz
    vx = b[AT_V] + qx - a[AT_V] - px
    vy = b[AT_V + 1] + qy - a[AT_V + 1] - py
    vz = b[AT_V + 2] + qz - a[AT_V + 2] - pz
    cx, cy, cz = cross(nx, ny, nz, dx, dy, dz)  # n x d, as long as the part of d across n
    kx, ky, kz = own[LINE], own[LINE + 1], own[LINE + 2]
    hx, hy, hz = cross(nx, ny, nz, kx, ky, kz)
    inverse = 1.0 / (cx * cx + cy * cy + cz * cz)
    angle = math.atan2(hx * dx + hy * dy + hz * dz, hx * cx + hy * cy + hz * cz)
    turn = inverse * (cx * vx + cy * vy + cz * vz)
    mx, my, mz = cross(cx, cy, cz, nx, ny, nz)  # the part of d across n
    bend = inverse * (cx * (fx - ex) + cy * (fy - ey) + cz * (fz - ez))
    bend -= 2.0 * inverse * turn * (mx * vx + my * vy + mz * vz)
    cx, cy, cz = part * inverse * cx, part * inverse * cy, part * inverse * cz
    put(row, AT_J, cx, cy, cz)
    put(row, AT_J + 6, -cx, -cy, -cz)
    gx, gy, gz = cross(rx, ry, rz, cx, cy, cz)
    row[AT_J + 3], row[AT_J + 4], row[AT_J + 5] = row[AT_J + 3] + gx, row[AT_J + 4] + gy, row[AT_J + 5] + gz
    gx, gy, gz = cross(sx, sy, sz, cx, cy, cz)
    row[AT_J + 9], row[AT_J + 10], row[AT_J + 11] = row[AT_J + 9] - gx, row[AT_J + 10] - gy, row[AT_J + 11] - gz
    return angle, turn, bend


@lean(types.void(A, A, A, A))
def write_gear(a, b, own, row):
    """Write the row of a GEAR between two movers."""
    for k in range(12):
        row[AT_J + k] = 0.0
    total = speed = 0.0
    size = abs(own[TEETH]) + abs(own[TEETH + 1])
    for side in range(2):
        m, at, part = (b, 9, own[TEETH + 1]) if side == 1 else (a, 0, own[TEETH])
        nx, ny, nz = own[at], own[at + 1], own[at + 2]
        ex, ey, ez = own[at + 3], own[at + 4], own[at + 5]
        ux, uy, uz = turned(m, AT_R, own[at + 6], own[at + 7], own[at + 8])
        sx, sy, sz = cross(ex, ey, ez, ux, uy, uz)
        total += part * math.atan2(nx * sx + ny * sy + nz * sz, ex * ux + ey * uy + ez * uz)
        part /= size
        speed += part * (nx * m[AT_W] + ny * m[AT_W + 1] + nz * m[AT_W + 2])
        put(row, AT_J + 6 * side + 3, part * nx, part * ny, part * nz)
    row[AT_BIAS] = 0.0
    if own[LENGTH] > 0.0:
        part = own[TEETH] + own[TEETH + 1]
        angle, turn, bend = write_line(a, b, own, row, part / size)
        total -= part * angle
        speed -= part / size * turn
        row[AT_BIAS] -= part / size * bend
    total -= 2.0 * math.pi * math.floor(total / (2.0 * math.pi) + 0.5)
    row[AT_C] = total / size
    row[AT_SPEED], row[AT_SIZE] = speed, 1.0
