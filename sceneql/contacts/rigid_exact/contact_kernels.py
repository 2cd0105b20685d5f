# mypy: ignore-errors
"""A contact of two rigid bodies as it moves: its gap, its normal, how both turn, and its rows of speeds and forces.

A contact is of two features, which are fixed in their bodies: corner and face, edge and edge, corner and corner (or
centers of balls), corner and edge; both may be rounded by a radius. With D n from the nearest point of the one to that
of the other, the gap is D - R, and of the accelerations of the points that are nearest now

    gap'' = n . (a_A - a_B) + 2 n' . (v_A - v_B) - D |n'|^2,

n' by the features. Where nothing slides, the speeds u_T across n change by the accelerations of the bodies at the
contact, and as it wanders over both surfaces (Montana 1988): w_A x (c' - v_A) - w_B x (c' - v_B), c' its velocity.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_MASS, AT_V, AT_W, AT_X, cross, put, turned
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import A, F, N

CORNER_FACE, FACE_CORNER, EDGES, CORNERS, CORNER_EDGE, EDGE_CORNER = range(6)
"""Kinds, the feature of a first."""
SLOW, FAST = 1.0, 2.0
"""Ways to slide: so slowly that friction is against the pull, not the speed; else."""
KIND, OWN_A, OWN_B, LINE_A, LINE_B, RADIUS_A, RADIUS_B, SIGN = 0, 1, 4, 7, 10, 13, 14, 15
SHAPE_A, SHAPE_B, PAIR, SLIDES, PUSHES, ALONG, FORCE, EXTENT, SLIP = 16, 17, 18, 19, 20, 21, 24, 27, 28
NORMAL, POINT, GAP, SPEED, SLIDE, BIAS, FIRST, SECOND, ROWS, AIMED = 29, 32, 35, 36, 37, 40, 43, 46, 49, 85
OF, DRIFT, TURNS, TURN_SLIP, TURN, TURN_ALONG, TURN_AIMED, TORQUE, RECORD = 88, 89, 92, 93, 94, 97, 100, 103, 106
"""Numbers of a contact. Kept: its kind; a point of each body, in its axes; the face's normal or the edge's direction of
each, in its axes; both radii; the sign of the normal of two edges; the numbers of both shapes, and of their pair;
whether it slides (0: it sticks) and pushes; the direction of slip then (3); its force along normal and tangents (3);
how far inside its face it was, and how fast it slid, when these were written. Of a state: normal, point, gap, dgap/dt,
slip (3); the biases of normal and tangents; two tangents; three rows by velocity and angular velocity of a, then of b;
the direction of slip now. Kept, too: of what is round on a polyhedron, the number of its face, edge or corner (else
-1); and of a curved one now, which way it drifts over that. Where a moment resists rolling, as of the slip, of the spin
of a against b: whether it turns, how fast it did and which way; it now, the direction of it now, and the moment."""


@lean_inlined
def dot(a, b, c, x, y, z):
    """Scalar product."""
    return a * x + b * y + c * z


@lean_inlined
def three(floats, at):
    """Three numbers."""
    return floats[at], floats[at + 1], floats[at + 2]


@lean(types.UniTuple(F, 6)(F, F, F))
def across(nx, ny, nz):
    """Two unit vectors across a unit vector."""
    if abs(nx) <= min(abs(ny), abs(nz)):
        x, y, z = cross(nx, ny, nz, 1.0, 0.0, 0.0)
    elif abs(ny) <= abs(nz):
        x, y, z = cross(nx, ny, nz, 0.0, 1.0, 0.0)
    else:
        x, y, z = cross(nx, ny, nz, 0.0, 0.0, 1.0)
    length = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    p, q, r = cross(nx, ny, nz, x, y, z)
    return x, y, z, p, q, r


@lean_inlined
def is_mass(floats, m):
    """Whether the mover whose floats begin at m is a mass without a rotation."""
    g = m + AT_INVERSE
    return floats[m + AT_MASS] != 0.0 and floats[g] == 0.0 and floats[g + 4] == 0.0 and floats[g + 8] == 0.0


@lean(types.void(A, N, N, N, F, F, F, F, F, F, F, F, F))
def place(floats, at, a, b, nx, ny, nz, cx, cy, cz, gx, gy, gz):
    """Write the slip and the rows of a contact at (cx, cy, cz) that moves at (gx, gy, gz)."""
    xa, ya, za = three(floats, a + AT_X)
    xb, yb, zb = three(floats, b + AT_X)
    va = three(floats, a + AT_V)
    vb = three(floats, b + AT_V)
    wa = three(floats, a + AT_W)
    wb = three(floats, b + AT_W)
    put(floats, at + POINT, cx, cy, cz)
    put(floats, at + TURN, wa[0] - wb[0], wa[1] - wb[1], wa[2] - wb[2])
    for m in (a, b):
        if is_mass(floats, m):  # which nothing turns: friction acts at its middle
            cx, cy, cz = three(floats, m + AT_X)
            gx, gy, gz = three(floats, m + AT_V)
    px, py, pz, qx, qy, qz = cx - xa, cy - ya, cz - za, cx - xb, cy - yb, cz - zb
    sx, sy, sz = cross(wa[0], wa[1], wa[2], px, py, pz)
    tx, ty, tz = cross(wb[0], wb[1], wb[2], qx, qy, qz)
    ux, uy, uz = va[0] + sx - vb[0] - tx, va[1] + sy - vb[1] - ty, va[2] + sz - vb[2] - tz
    part = dot(nx, ny, nz, ux, uy, uz)
    put(floats, at + SLIDE, ux - part * nx, uy - part * ny, uz - part * nz)
    sx, sy, sz = cross(wa[0], wa[1], wa[2], gx - va[0], gy - va[1], gz - va[2])
    tx, ty, tz = cross(wb[0], wb[1], wb[2], gx - vb[0], gy - vb[1], gz - vb[2])
    ux, uy, uz, lx, ly, lz = across(nx, ny, nz)
    put(floats, at + FIRST, ux, uy, uz)
    put(floats, at + SECOND, lx, ly, lz)
    floats[at + BIAS + 1] = dot(ux, uy, uz, sx - tx, sy - ty, sz - tz)
    floats[at + BIAS + 2] = dot(lx, ly, lz, sx - tx, sy - ty, sz - tz)
    for k in range(3):
        ex, ey, ez = (nx, ny, nz) if k == 0 else ((ux, uy, uz) if k == 1 else (lx, ly, lz))
        row = at + ROWS + 12 * k
        put(floats, row, ex, ey, ez)
        put(floats, row + 3, *cross(px, py, pz, ex, ey, ez))
        put(floats, row + 6, -ex, -ey, -ez)
        fx, fy, fz = cross(qx, qy, qz, ex, ey, ez)
        put(floats, row + 9, -fx, -fy, -fz)


@lean(types.void(A, N, N, N))
def follow(floats, at, a, b):
    """Write what a contact at floats[at:] is in the state of its movers, whose floats begin at a and b."""
    kind = int(floats[at + KIND])
    ra, rb = floats[at + RADIUS_A], floats[at + RADIUS_B]
    xa, ya, za = three(floats, a + AT_X)
    xb, yb, zb = three(floats, b + AT_X)
    va = three(floats, a + AT_V)
    vb = three(floats, b + AT_V)
    wa = three(floats, a + AT_W)
    wb = three(floats, b + AT_W)
    # Arms of both points, the vector from that of b to that of a, lines of both.
    px, py, pz = turned(floats, a + AT_TURN, *three(floats, at + OWN_A))
    qx, qy, qz = turned(floats, b + AT_TURN, *three(floats, at + OWN_B))
    dx, dy, dz = xa + px - xb - qx, ya + py - yb - qy, za + pz - zb - qz
    ex, ey, ez = turned(floats, a + AT_TURN, *three(floats, at + LINE_A))
    fx, fy, fz = turned(floats, b + AT_TURN, *three(floats, at + LINE_B))
    nx = ny = nz = mx = my = mz = 0.0  # normal and its derivative
    away = 0.0
    if kind == CORNER_FACE:
        nx, ny, nz = fx, fy, fz
        mx, my, mz = cross(wb[0], wb[1], wb[2], nx, ny, nz)
        away = dot(nx, ny, nz, dx, dy, dz)
        qx, qy, qz = xa + px - away * nx - xb, ya + py - away * ny - yb, za + pz - away * nz - zb
    elif kind == FACE_CORNER:
        nx, ny, nz = -ex, -ey, -ez
        mx, my, mz = cross(wa[0], wa[1], wa[2], nx, ny, nz)
        away = dot(nx, ny, nz, dx, dy, dz)
        px, py, pz = xb + qx + away * nx - xa, yb + qy + away * ny - ya, zb + qz + away * nz - za
    elif kind == EDGES:
        cx, cy, cz = cross(ex, ey, ez, fx, fy, fz)
        square = cx * cx + cy * cy + cz * cz
        length = math.sqrt(square) * floats[at + SIGN]
        nx, ny, nz = cx / length, cy / length, cz / length
        away = dot(nx, ny, nz, dx, dy, dz)
        gx, gy, gz = away * nx - dx, away * ny - dy, away * nz - dz
        alpha = dot(*cross(gx, gy, gz, fx, fy, fz), cx, cy, cz) / square
        beta = dot(*cross(gx, gy, gz, ex, ey, ez), cx, cy, cz) / square
        px, py, pz = px + alpha * ex, py + alpha * ey, pz + alpha * ez
        qx, qy, qz = qx + beta * fx, qy + beta * fy, qz + beta * fz
        ux, uy, uz = cross(*cross(wa[0], wa[1], wa[2], ex, ey, ez), fx, fy, fz)
        tx, ty, tz = cross(ex, ey, ez, *cross(wb[0], wb[1], wb[2], fx, fy, fz))
        ux, uy, uz = (ux + tx) / length, (uy + ty) / length, (uz + tz) / length
        part = dot(nx, ny, nz, ux, uy, uz)
        mx, my, mz = ux - part * nx, uy - part * ny, uz - part * nz
    else:
        sx, sy, sz = cross(wa[0], wa[1], wa[2], px, py, pz)
        tx, ty, tz = cross(wb[0], wb[1], wb[2], qx, qy, qz)
        ux, uy, uz = va[0] + sx - vb[0] - tx, va[1] + sy - vb[1] - ty, va[2] + sz - vb[2] - tz
        if kind != CORNERS:
            # The part of d across the edge.
            lx, ly, lz = (fx, fy, fz) if kind == CORNER_EDGE else (ex, ey, ez)
            w = wb if kind == CORNER_EDGE else wa
            kx, ky, kz = cross(w[0], w[1], w[2], lx, ly, lz)
            along = dot(dx, dy, dz, lx, ly, lz)
            grows = dot(ux, uy, uz, lx, ly, lz) + dot(dx, dy, dz, kx, ky, kz)
            ux, uy, uz = (
                ux - grows * lx - along * kx,
                uy - grows * ly - along * ky,
                uz - grows * lz - along * kz,
            )
            dx, dy, dz = dx - along * lx, dy - along * ly, dz - along * lz
        away = math.sqrt(dx * dx + dy * dy + dz * dz)
        if away > 0.0:
            nx, ny, nz = dx / away, dy / away, dz / away
            part = dot(nx, ny, nz, ux, uy, uz)
            mx, my, mz = (ux - part * nx) / away, (uy - part * ny) / away, (uz - part * nz) / away
        else:
            nx, ny, nz = three(floats, at + NORMAL)
        if kind == CORNER_EDGE:
            qx, qy, qz = xa + px - dx - xb, ya + py - dy - yb, za + pz - dz - zb
        elif kind == EDGE_CORNER:
            px, py, pz = xb + qx + dx - xa, yb + qy + dy - ya, zb + qz + dz - za
    # The speeds and the accelerations by spin of the points that are nearest.
    sx, sy, sz = cross(wa[0], wa[1], wa[2], px, py, pz)
    tx, ty, tz = cross(wb[0], wb[1], wb[2], qx, qy, qz)
    gx, gy, gz = cross(wa[0], wa[1], wa[2], sx, sy, sz)
    hx, hy, hz = cross(wb[0], wb[1], wb[2], tx, ty, tz)
    ux, uy, uz = va[0] + sx - vb[0] - tx, va[1] + sy - vb[1] - ty, va[2] + sz - vb[2] - tz
    bias = dot(nx, ny, nz, gx - hx, gy - hy, gz - hz) + 2.0 * dot(mx, my, mz, ux, uy, uz)
    bias -= away * (mx * mx + my * my + mz * mz)
    floats[at + GAP] = away - ra - rb
    floats[at + SPEED] = dot(nx, ny, nz, ux, uy, uz)
    floats[at + BIAS] = bias
    put(floats, at + NORMAL, nx, ny, nz)
    # The contact, and how fast it moves.
    if kind == FACE_CORNER or kind == EDGE_CORNER:
        cx, cy, cz = xb + qx + rb * nx, yb + qy + rb * ny, zb + qz + rb * nz
        gx, gy, gz = vb[0] + tx + rb * mx, vb[1] + ty + rb * my, vb[2] + tz + rb * mz
    else:
        cx, cy, cz = xa + px - ra * nx, ya + py - ra * ny, za + pz - ra * nz
        gx, gy, gz = va[0] + sx - ra * mx, va[1] + sy - ra * my, va[2] + sz - ra * mz
    place(floats, at, a, b, nx, ny, nz, cx, cy, cz, gx, gy, gz)


@lean(F(A, N, N, N))
def pace(floats, at, a, b):
    """Size of the speeds of a contact: what its speeds are sums of."""
    total = 0.0
    for side in range(2):
        mover = a if side == 0 else b
        arm = 0.0
        for c in range(3):
            total += abs(floats[mover + AT_V + c])
            arm += abs(floats[at + POINT + c] - floats[mover + AT_X + c])
        for c in range(3):
            total += arm * abs(floats[mover + AT_W + c])
    return total
