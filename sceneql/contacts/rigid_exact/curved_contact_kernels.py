# mypy: ignore-errors
"""A contact of a curved body a with a face, an edge or a corner of b as it moves.

The gap is D = n . (p_a - p_b), n the unit normal from b to a, both points those that are nearest. They wander over both
surfaces: with c their velocities and v those of the bodies there,

    D'' = n . (a_A + w_A' x r_A - a_B - w_B' x r_B) + n' . (v_A - v_B) + n . (w_A x (c_A - v_a) - w_B x (c_B - v_b)),

and c_A = c_B + D' n + D n'. Against a face n turns with b and p_a is the point of a that is farthest along -n; on an
edge, or a corner, of b the normal is that of a there, which turns with a and as the surface bends.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_V, AT_W, AT_X, cross, put, turned
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.core_kernels import REACH
from sceneql.contacts.rigid_exact.contact_kernels import (
    BIAS,
    DRIFT,
    GAP,
    KIND,
    LINE_A,
    LINE_B,
    NORMAL,
    OWN_A,
    OWN_B,
    RADIUS_B,
    SIGN,
    SPEED,
    dot,
    place,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import follow as follow_flat
from sceneql.contacts.rigid_exact.curved import ELLIPSOID, FORM
from sceneql.contacts.rigid_exact.curved_surface_kernels import away, bend, farthest, into, out_of, wander
from sceneql.contacts.rigid_exact.stop_kernels import STOP, follow_stop
from sceneql.system.signatures_kernels import A, F, I, N

ON_FACE, ON_EDGE, ON_CORNER, ON_RIM, ON_RIMS = 6, 7, 8, 10, 11
"""Kinds of contacts, beside those of contact_kernels: of a curved body on a feature of b; of a rim of a column on an
edge, and on a rim of another (rim_crossing_kernels). LINE_A: where the numbers of the curved shape begin, of an edge
how far along its direction from OWN_B it touches, and of a rim that meets what is sharp the angle; OWN_B: of two rims
where b's numbers begin, the angle, and which rim of b it is; SIGN: the rim of a column; OWN_A: of a ring or column on a
face which way, of its own axes, it was tilted when it was found (rim_kernels)."""
follow_crossing = lazy("sceneql.contacts.rigid_exact.rim_crossing_kernels:follow_crossing", types.void(A, N, N, N))
FLAT = 1e-9
"""Sine of the angle between face and circle up to which it lies flat."""
TURNS = 30
"""Most steps of Newton's method along an edge."""


@lean_inlined
def own(floats, mover, x, y, z):
    """A vector of the world in a mover's axes."""
    r = mover + AT_TURN
    return (
        floats[r] * x + floats[r + 3] * y + floats[r + 6] * z,
        floats[r + 1] * x + floats[r + 4] * y + floats[r + 7] * z,
        floats[r + 2] * x + floats[r + 5] * y + floats[r + 8] * z,
    )


@lean_inlined
def speed_at(floats, mover, x, y, z):
    """The velocity of a mover at a place of the world."""
    w = three(floats, mover + AT_W)
    px, py, pz = three(floats, mover + AT_X)
    sx, sy, sz = cross(w[0], w[1], w[2], x - px, y - py, z - pz)
    vx, vy, vz = three(floats, mover + AT_V)
    return vx + sx, vy + sy, vz + sz


@lean_inlined
def turns_at(floats, ints, a, shape, p, gap, n, e):
    """How fast the normal of a curved body turns, in its own motion, while a point p of its axes moves at e, in the
    world; n and what is told are in the world, too."""
    nx, ny, nz = own(floats, a, n[0], n[1], n[2])
    ex, ey, ez = own(floats, a, e[0], e[1], e[2])
    x, y, z = bend(floats, ints, shape, p[0], p[1], p[2], gap, nx, ny, nz, ex, ey, ez)
    return turned(floats, a + AT_TURN, x, y, z)


@lean(types.void(A, N, N, N, F, F, F, F, F, F, F, F, F, F, F, F, F))
def write(floats, at, a, b, gap, nx, ny, nz, mx, my, mz, cx, cy, cz, gx, gy, gz):
    """Write a contact: its gap, its normal and how this turns, the point of a and how that moves."""
    ux, uy, uz = speed_at(floats, a, cx, cy, cz)
    vx, vy, vz = speed_at(floats, b, cx - gap * nx, cy - gap * ny, cz - gap * nz)
    ux, uy, uz = ux - vx, uy - vy, uz - vz
    speed = dot(nx, ny, nz, ux, uy, uz)
    hx, hy, hz = gx - speed * nx - gap * mx, gy - speed * ny - gap * my, gz - speed * nz - gap * mz
    va, vb = three(floats, a + AT_V), three(floats, b + AT_V)
    wa, wb = three(floats, a + AT_W), three(floats, b + AT_W)
    px, py, pz = cross(wa[0], wa[1], wa[2], gx - va[0], gy - va[1], gz - va[2])
    qx, qy, qz = cross(wb[0], wb[1], wb[2], hx - vb[0], hy - vb[1], hz - vb[2])
    floats[at + GAP], floats[at + SPEED] = gap, speed
    floats[at + BIAS] = dot(mx, my, mz, ux, uy, uz) + dot(nx, ny, nz, px - qx, py - qy, pz - qz)
    put(floats, at + NORMAL, nx, ny, nz)
    # Over a face as the point moves, over an edge or a corner as the normal turns.
    far = floats[int(floats[at + LINE_A]) + REACH]
    tx, ty, tz = cross(wb[0], wb[1], wb[2], nx, ny, nz)
    put(
        floats, at + DRIFT, hx - vx + far * (mx - tx), hy - vy + far * (my - ty), hz - vz + far * (mz - tz),
    )  # fmt: skip
    place(floats, at, a, b, nx, ny, nz, cx, cy, cz, gx, gy, gz)


@lean(types.void(A, N, N, N))
def follow_on_face(floats, at, a, b):
    """Write what a contact of a curved body on a face is now."""
    shape = int(floats[at + LINE_A])
    nx, ny, nz = turned(floats, b + AT_TURN, *three(floats, at + LINE_B))
    dx, dy, dz = own(floats, a, -nx, -ny, -nz)
    turn, on, px, py, pz = 1.0, 1.0, dx, dy, dz
    if floats[shape + FORM] != ELLIPSOID:
        x, y, z = into(floats, shape, dx, dy, dz)
        u, w = floats[at + OWN_A], floats[at + OWN_A + 2]
        if x * x + z * z < FLAT * FLAT and (u != 0.0 or w != 0.0):
            # On its way through the face's plane: the point stays.
            on = 0.0
            px, py, pz = out_of(floats, shape, FLAT * u, y, FLAT * w)
        elif x * u + z * w < -0.5 * math.sqrt(x * x + z * z):
            turn = on = -1.0
    rx, ry, rz = turned(floats, a + AT_TURN, *farthest(floats, shape, px, py, pz, floats[at + SIGN], turn))
    qx, qy, qz = turned(floats, b + AT_TURN, *three(floats, at + OWN_B))
    cx, cy, cz = three(floats, a + AT_X)
    cx, cy, cz = cx + rx, cy + ry, cz + rz
    ox, oy, oz = three(floats, b + AT_X)
    gap = dot(nx, ny, nz, cx - ox - qx, cy - oy - qy, cz - oz - qz) - floats[at + RADIUS_B]
    wa, wb = three(floats, a + AT_W), three(floats, b + AT_W)
    mx, my, mz = cross(wb[0], wb[1], wb[2], nx, ny, nz)
    ex, ey, ez = own(floats, a, *cross(wa[0] - wb[0], wa[1] - wb[1], wa[2] - wb[2], nx, ny, nz))
    ex, ey, ez = turned(floats, a + AT_TURN, *wander(floats, shape, dx, dy, dz, ex, ey, ez, on))
    gx, gy, gz = speed_at(floats, a, cx, cy, cz)
    write(floats, at, a, b, gap, nx, ny, nz, mx, my, mz, cx, cy, cz, gx + ex, gy + ey, gz + ez)


@lean(types.void(A, I, N, N, N))
def follow_on_corner(floats, ints, at, a, b):
    """Write what a contact of a curved body on an edge or a corner, which may be rounded, is now."""
    shape, radius = int(floats[at + LINE_A]), floats[at + RADIUS_B]
    ox, oy, oz = three(floats, b + AT_X)
    rx, ry, rz = turned(floats, b + AT_TURN, *three(floats, at + OWN_B))
    ox, oy, oz = ox + rx, oy + ry, oz + rz
    tx = ty = tz = 0.0
    if floats[at + KIND] == ON_EDGE:
        tx, ty, tz = turned(floats, b + AT_TURN, *three(floats, at + LINE_B))
    ax, ay, az = three(floats, a + AT_X)
    s, bends = (floats[at + LINE_A + 1] if floats[at + KIND] == ON_EDGE else 0.0), 0.0
    x, y, z = ox, oy, oz
    px, py, pz = own(floats, a, x - ax, y - ay, z - az)
    distance, nx, ny, nz = away(floats, ints, shape, px, py, pz)
    if floats[at + KIND] == ON_EDGE:
        least, step = math.inf, 0.0
        for _ in range(TURNS):
            x, y, z = ox + s * tx, oy + s * ty, oz + s * tz
            px, py, pz = own(floats, a, x - ax, y - ay, z - az)
            distance, nx, ny, nz = away(floats, ints, shape, px, py, pz)
            nx, ny, nz = turned(floats, a + AT_TURN, nx, ny, nz)
            ex, ey, ez = turns_at(floats, ints, a, shape, (px, py, pz), distance, (nx, ny, nz), (tx, ty, tz))
            bends, slope = dot(tx, ty, tz, ex, ey, ez), dot(tx, ty, tz, nx, ny, nz)
            tiny = 1e-15 * (abs(px) + abs(py) + abs(pz))
            if abs(slope) > least and abs(step) > tiny:  # too far: half way back
                step *= 0.5
                s -= step
                continue
            least, step = abs(slope), (-slope / bends if bends > 0.0 else 0.0)
            if not abs(step) > tiny:
                break
            s += step
        floats[at + LINE_A + 1] = s
    else:
        nx, ny, nz = turned(floats, a + AT_TURN, nx, ny, nz)
    # The place of b against a: how it moves, and how the normal turns by that.
    wa, wb = three(floats, a + AT_W), three(floats, b + AT_W)
    vx, vy, vz = speed_at(floats, b, x, y, z)
    ux, uy, uz = speed_at(floats, a, x, y, z)
    ux, uy, uz = vx - ux, vy - uy, vz - uz
    if floats[at + KIND] == ON_EDGE and bends > 0.0:
        ex, ey, ez = turns_at(floats, ints, a, shape, (px, py, pz), distance, (nx, ny, nz), (ux, uy, uz))
        fx, fy, fz = cross(wb[0] - wa[0], wb[1] - wa[1], wb[2] - wa[2], tx, ty, tz)
        along = -(dot(fx, fy, fz, nx, ny, nz) + dot(tx, ty, tz, ex, ey, ez)) / bends
        ux, uy, uz, vx, vy, vz = (
            *(ux + along * tx, uy + along * ty, uz + along * tz),
            *(vx + along * tx, vy + along * ty, vz + along * tz),
        )
    ex, ey, ez = turns_at(floats, ints, a, shape, (px, py, pz), distance, (nx, ny, nz), (ux, uy, uz))
    fx, fy, fz = cross(wa[0], wa[1], wa[2], nx, ny, nz)
    mx, my, mz = ex + fx, ey + fy, ez + fz
    grows = dot(nx, ny, nz, ux, uy, uz)
    cx, cy, cz = x - distance * nx, y - distance * ny, z - distance * nz
    gx, gy, gz = (
        vx - grows * nx - distance * mx,
        vy - grows * ny - distance * my,
        vz - grows * nz - distance * mz,
    )
    write(floats, at, a, b, distance - radius, -nx, -ny, -nz, -mx, -my, -mz, cx, cy, cz, gx, gy, gz)


@lean(types.void(A, I, N, N, N))
def follow(floats, ints, at, a, b):
    """Write what a contact at floats[at:] is in the state of its movers, whose floats begin at a and b."""
    kind = floats[at + KIND]
    if kind == ON_FACE:
        follow_on_face(floats, at, a, b)
    elif kind == ON_EDGE or kind == ON_CORNER:
        follow_on_corner(floats, ints, at, a, b)
    elif kind == STOP:
        follow_stop(floats, at, a)
    elif kind == ON_RIM or kind == ON_RIMS:
        follow_crossing(floats, at, a, b)
    else:
        follow_flat(floats, at, a, b)
