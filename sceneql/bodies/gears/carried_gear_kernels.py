# mypy: ignore-errors
"""The row of a gear whose wheels turn in what moves itself: a housing that tumbles, an arm (tie_rows_kernels.CARRIED).

A wheel a carries its axis n. Its angle A counts against a direction e that its housing carries too, so that the rate of
A is that of the wheel against the housing about n, without a row for the housing: with s = e' - w x e, how e moves
as seen from the wheel, and c = n x e, dA/dt = -c . s / c^2. For e both wheels take the line from axle to axle, d, or,
where the axes are not parallel, the axis of the other. A and B depend on how the two lie to each other alone:
whatever the forces of the row, momentum and angular momentum of both together stay. Along a line they are the force of
the teeth, where they meet.
"""

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
    OF_ARMS,
    OF_LINE,
    OF_TEETH,
    arm,
    cross,
    turned,
)
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A, F, N

THREE = types.UniTuple(F, 3)


@lean_inlined
def add(row, to, x, y, z):
    """Add a vector to three numbers of J."""
    row[AT_J + to] += x
    row[AT_J + to + 1] += y
    row[AT_J + to + 2] += z


@lean(types.UniTuple(F, 3)(A, A, N, F, THREE, THREE, THREE, A))
def count(m, own, side, part, e, fast, bend, row):
    """Add to a row `part` of the angle by which a wheel has turned against e, which moves by e' = fast, e'' = bend.

    Of J only what the wheel's own spin does is added. Returns part c/c^2, of which e' has the negative in J.
    """
    nx, ny, nz = turned(m, AT_R, own[3 * side], own[3 * side + 1], own[3 * side + 2])
    ux, uy, uz = turned(m, AT_R, own[6 + 3 * side], own[7 + 3 * side], own[8 + 3 * side])
    ex, ey, ez = e
    fx, fy, fz = fast
    bx, by, bz = bend
    wx, wy, wz = m[AT_W], m[AT_W + 1], m[AT_W + 2]
    cx, cy, cz = cross(nx, ny, nz, ex, ey, ez)
    inverse = 1.0 / (cx * cx + cy * cy + cz * cz)
    vx, vy, vz = cross(nx, ny, nz, ux, uy, uz)
    angle = math.atan2(vx * ex + vy * ey + vz * ez, ux * ex + uy * ey + uz * ez)
    px, py, pz = cross(wx, wy, wz, ex, ey, ez)
    sx, sy, sz = fx - px, fy - py, fz - pz
    # In the wheel's axes e'' is e'' - 2 w x e' + w x (w x e) = e'' - w x (e' + s), in the world's.
    qx, qy, qz = cross(wx, wy, wz, fx + sx, fy + sy, fz + sz)
    mx, my, mz = cross(cx, cy, cz, nx, ny, nz)  # the part of e across n
    speed = inverse * (cx * sx + cy * sy + cz * sz)
    bent = inverse * (cx * (bx - qx) + cy * (by - qy) + cz * (bz - qz))
    bent -= 2.0 * inverse * speed * (mx * sx + my * sy + mz * sz)
    row[AT_C] -= part * angle
    row[AT_SPEED] -= part * speed
    row[AT_BIAS] -= part * bent
    part *= inverse
    cx, cy, cz = part * cx, part * cy, part * cz
    gx, gy, gz = cross(ex, ey, ez, cx, cy, cz)
    add(row, 6 * side + 3, gx, gy, gz)
    return cx, cy, cz


@lean(types.void(A, A, A, F, A))
def write_line(a, b, own, part, row):
    """Both wheels against the line from axle to axle, each by its teeth times `part`."""
    rx, ry, rz, px, py, pz, ex, ey, ez = arm(a, own, OF_ARMS)
    sx, sy, sz, qx, qy, qz, fx, fy, fz = arm(b, own, OF_ARMS + 3)
    line = (
        b[AT_X] + sx - a[AT_X] - rx,
        b[AT_X + 1] + sy - a[AT_X + 1] - ry,
        b[AT_X + 2] + sz - a[AT_X + 2] - rz,
    )
    fast = (
        b[AT_V] + qx - a[AT_V] - px,
        b[AT_V + 1] + qy - a[AT_V + 1] - py,
        b[AT_V + 2] + qz - a[AT_V + 2] - pz,
    )
    bend = (fx - ex, fy - ey, fz - ez)
    for side in range(2):
        m = b if side == 1 else a
        cx, cy, cz = count(m, own, side, part * own[OF_TEETH + side], line, fast, bend, row)
        # e' = v_b + w_b x s - v_a - w_a x r
        add(row, 0, cx, cy, cz)
        add(row, 6, -cx, -cy, -cz)
        gx, gy, gz = cross(rx, ry, rz, cx, cy, cz)
        add(row, 3, gx, gy, gz)
        gx, gy, gz = cross(sx, sy, sz, cx, cy, cz)
        add(row, 9, -gx, -gy, -gz)


@lean(types.void(A, A, A, F, A))
def write_axes(a, b, own, part, row):
    """Each wheel against the axis of the other, by its teeth times `part`."""
    for side in range(2):
        m, other = (b, a) if side == 1 else (a, b)
        nx, ny, nz, px, py, pz, ex, ey, ez = arm(other, own, 3 - 3 * side)
        teeth = part * own[OF_TEETH + side]
        cx, cy, cz = count(m, own, side, teeth, (nx, ny, nz), (px, py, pz), (ex, ey, ez), row)
        gx, gy, gz = cross(nx, ny, nz, cx, cy, cz)
        add(row, 9 - 6 * side, -gx, -gy, -gz)


@lean(types.void(A, A, A, A))
def write_carried(a, b, own, row):
    """Write the row of a CARRIED between two movers."""
    for k in range(12):
        row[AT_J + k] = 0.0
    row[AT_C] = row[AT_SPEED] = row[AT_BIAS] = 0.0
    size = abs(own[OF_TEETH]) + abs(own[OF_TEETH + 1])
    if own[OF_LINE] > 0.0:
        write_line(a, b, own, 1.0 / size, row)
    else:
        write_axes(a, b, own, 1.0 / size, row)
    turn = 2.0 * math.pi / size
    row[AT_C] -= turn * math.floor(row[AT_C] / turn + 0.5)
    row[AT_SIZE] = 1.0
