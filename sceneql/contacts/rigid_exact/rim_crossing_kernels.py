# mypy: ignore-errors
"""Contacts of two sharp curves: a rim of a column with an edge of a polyhedron, or with a rim of another column.

Where they cross, the normal is across both tangents; the distance of the curves tells none there. With E from the place
of b to that of a, which are the nearest, E . t_a = E . t_b = 0 in both tangents: these conditions find both places by
Newton's method, and by their derivatives in time how the places wander. Of a circle t' = w x t - s' e / R, s' being how
fast its place runs, e the direction outward.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_W, AT_X, cross, turned
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.core_kernels import FLOATS
from sceneql.contacts.rigid_exact.contact_kernels import (
    KIND,
    LINE_A,
    LINE_B,
    OF,
    OWN_B,
    POINT,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    dot,
    three,
)
from sceneql.contacts.rigid_exact.curved import CENTER, SIZES
from sceneql.contacts.rigid_exact.curved_contact_kernels import ON_FACE, ON_RIM, own, speed_at, write
from sceneql.contacts.rigid_exact.curved_surface_kernels import into, out_of
from sceneql.contacts.rigid_exact.exact_rows_kernels import SHAPES_AT, core_at, mover_at
from sceneql.contacts.rigid_exact.features_kernels import inside_edge, smaller
from sceneql.contacts.rigid_exact.rim_kernels import on_circle
from sceneql.system.signatures_kernels import A, F, I, N

ALONGSIDE = 1e-6
"""Square of the sine of the angle of two tangents below which the curves do not cross, but run beside each other."""
TURNS = 30
"""Most steps of Newton's method."""
SMALL = 1e-11
"""Last step of these, whose square is rounding: in radians, and in parts of the lengths."""
CURVE = types.UniTuple(F, 9)
PLACES = types.UniTuple(F, 3)


@lean(CURVE(A, N, N, F, F))
def rim(floats, mover, f, sign, angle):
    """A place of a rim, the direction outward across it, and its tangent, in the world."""
    u, w = math.cos(angle), math.sin(angle)
    px, py, pz = turned(floats, mover + AT_TURN, *on_circle(floats, f, sign, u, w))
    x, y, z = three(floats, mover + AT_X)
    ex, ey, ez = turned(floats, mover + AT_TURN, *out_of(floats, f, u, 0.0, w))
    return x + px, y + py, z + pz, ex, ey, ez, *turned(floats, mover + AT_TURN, *out_of(floats, f, -w, 0.0, u))


@lean(CURVE(A, N, N, F, F, F, F, F, F, F, F))
def other_curve(floats, mover, f, sign, s, ox, oy, oz, lx, ly, lz):
    """As `rim`, of a rim at the angle s, or without a shape (f < 0) of the edge from o along l at the length s."""
    if f >= 0:
        return rim(floats, mover, f, sign, s)
    tx, ty, tz = turned(floats, mover + AT_TURN, lx, ly, lz)
    px, py, pz = turned(floats, mover + AT_TURN, ox + s * lx, oy + s * ly, oz + s * lz)
    x, y, z = three(floats, mover + AT_X)
    return x + px, y + py, z + pz, 0.0, 0.0, 0.0, tx, ty, tz


@lean_inlined
def solved(p, q, r, s, u, v):
    """The solution of p x + q y = u, r x + s y = v."""
    by = p * s - q * r
    return (u * s - q * v) / by, (p * v - u * r) / by


@lean(PLACES(A, N, N, N, F, F, N, F, F, F, F, F, F, F, F))
def crossing(floats, a, b, fa, side, angle, fb, sign, s, ox, oy, oz, lx, ly, lz):
    """Where a rim of a and a curve of b are the nearest, from a guess: the angle, the place on the other curve, and 1;
    0 where the curves run beside each other, or none is found."""
    ra = floats[fa + SIZES]
    rb = floats[fb + SIZES] if fb >= 0 else 1.0
    for _ in range(TURNS):
        px, py, pz, ex, ey, ez, tx, ty, tz = rim(floats, a, fa, side, angle)
        qx, qy, qz, gx, gy, gz, ux, uy, uz = other_curve(floats, b, fb, sign, s, ox, oy, oz, lx, ly, lz)
        dx, dy, dz = px - qx, py - qy, pz - qz
        both = dot(tx, ty, tz, ux, uy, uz)
        if both * both > 1.0 - ALONGSIDE:
            return angle, s, 0.0
        x, y = solved(
            1.0 - dot(dx, dy, dz, ex, ey, ez) / ra, -both, both, -1.0 - dot(dx, dy, dz, gx, gy, gz) / rb,
            -dot(dx, dy, dz, tx, ty, tz), -dot(dx, dy, dz, ux, uy, uz),
        )  # fmt: skip
        x, y = x / ra, y / rb
        if not abs(x) + abs(y) < math.inf:
            return angle, s, 0.0
        most = 0.5 if fb >= 0 else math.inf
        part = min(1.0, 0.5 / max(abs(x), 1e-300), most / max(abs(y), 1e-300))
        angle, s = angle + part * x, s + part * y
        if abs(x) <= SMALL and abs(y) <= SMALL * (1.0 if fb >= 0 else ra + abs(s)):
            return angle, s, 1.0
    return angle, s, 0.0


@lean(types.UniTuple(F, 6)(A, N, N, N, F, F, N, F, F, F, F, F, F, F, F))
def normal_across(floats, a, b, fa, side, angle, fb, sign, s, ox, oy, oz, lx, ly, lz):
    """The outer normal of a at such a place, its parts along a's axis and outward across it, and how far b is along it
    [m], negative inside."""
    px, py, pz, ex, ey, ez, tx, ty, tz = rim(floats, a, fa, side, angle)
    qx, qy, qz, _, _, _, ux, uy, uz = other_curve(floats, b, fb, sign, s, ox, oy, oz, lx, ly, lz)
    kx, ky, kz = turned(floats, a + AT_TURN, *out_of(floats, fa, 0.0, side, 0.0))
    nx, ny, nz = cross(tx, ty, tz, ux, uy, uz)
    length = math.sqrt(dot(nx, ny, nz, nx, ny, nz))
    if dot(nx, ny, nz, kx + ex, ky + ey, kz + ez) < 0.0:
        length = -length
    nx, ny, nz = nx / length, ny / length, nz / length
    along, out = dot(nx, ny, nz, kx, ky, kz), dot(nx, ny, nz, ex, ey, ez)
    return nx, ny, nz, along, out, dot(nx, ny, nz, qx - px, qy - py, qz - pz)


@lean(types.void(A, N, N, N))
def follow_crossing(floats, at, a, b):
    """Write what a contact of a rim of a with an edge, or a rim, of b is now."""
    fa, side = int(floats[at + LINE_A]), floats[at + SIGN]
    edge = floats[at + KIND] == ON_RIM
    fb, sign = (-1, 0.0) if edge else (int(floats[at + OWN_B]), floats[at + OWN_B + 2])
    s_at = at + LINE_A + 1 if edge else at + OWN_B + 1
    o, l = (three(floats, at + OWN_B), three(floats, at + LINE_B)) if edge else ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    angle, s, _ = crossing(
        floats, a, b, fa, side, floats[at + LINE_A + 2], fb, sign, floats[s_at], o[0], o[1], o[2], l[0], l[1], l[2]
    )
    floats[at + LINE_A + 2], floats[s_at] = angle, s
    nx, ny, nz, _, _, deep = normal_across(
        floats, a, b, fa, side, angle, fb, sign, s, o[0], o[1], o[2], l[0], l[1], l[2]
    )
    px, py, pz, ex, ey, ez, tx, ty, tz = rim(floats, a, fa, side, angle)
    qx, qy, qz, gx, gy, gz, ux, uy, uz = other_curve(floats, b, fb, sign, s, o[0], o[1], o[2], l[0], l[1], l[2])
    ra = floats[fa + SIZES]
    rb = floats[fb + SIZES] if fb >= 0 else 1.0
    dx, dy, dz = px - qx, py - qy, pz - qz
    both = dot(tx, ty, tz, ux, uy, uz)
    wa, wb = three(floats, a + AT_W), three(floats, b + AT_W)
    vx, vy, vz = speed_at(floats, a, px, py, pz)
    mx, my, mz = speed_at(floats, b, qx, qy, qz)
    mx, my, mz = vx - mx, vy - my, vz - mz
    ix, iy, iz = cross(wa[0], wa[1], wa[2], tx, ty, tz)
    jx, jy, jz = cross(wb[0], wb[1], wb[2], ux, uy, uz)
    x, y = solved(
        1.0 - dot(dx, dy, dz, ex, ey, ez) / ra, -both, both, -1.0 - dot(dx, dy, dz, gx, gy, gz) / rb,
        -dot(mx, my, mz, tx, ty, tz) - dot(dx, dy, dz, ix, iy, iz),
        -dot(mx, my, mz, ux, uy, uz) - dot(dx, dy, dz, jx, jy, jz),
    )  # fmt: skip
    ix, iy, iz = ix - x * ex / ra, iy - x * ey / ra, iz - x * ez / ra
    jx, jy, jz = jx - y * gx / rb, jy - y * gy / rb, jz - y * gz / rb
    cx, cy, cz = cross(tx, ty, tz, ux, uy, uz)
    length = math.copysign(math.sqrt(dot(cx, cy, cz, cx, cy, cz)), dot(cx, cy, cz, nx, ny, nz))
    kx, ky, kz = cross(ix, iy, iz, ux, uy, uz)
    hx, hy, hz = cross(tx, ty, tz, jx, jy, jz)
    kx, ky, kz = (kx + hx) / length, (ky + hy) / length, (kz + hz) / length
    part = dot(kx, ky, kz, nx, ny, nz)
    kx, ky, kz = kx - part * nx, ky - part * ny, kz - part * nz
    write(floats, at, a, b, deep, -nx, -ny, -nz, -kx, -ky, -kz, px, py, pz, vx + x * tx, vy + x * ty, vz + x * tz)


@lean(F(A, I, N))
def inside_round(floats, ints, rec):
    """How far such a contact is from the end of its edge, or its normal from those of the faces beside the edge and of
    the column's two sides, times the size of the smaller body; one on the flat end of a column from its rim [m]."""
    m = int(floats[rec + SHAPE_B])
    a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, m)
    if floats[rec + KIND] == ON_FACE:
        f = ints[ints[SHAPES_AT] + SHAPE * m + FLOATS]
        px, py, pz = three(floats, rec + POINT)
        x, y, z = three(floats, b + AT_X)
        px, py, pz = own(floats, b, px - x, py - y, pz - z)
        x, _, z = into(floats, f, px - floats[f + CENTER], py - floats[f + CENTER + 1], pz - floats[f + CENTER + 2])
        return floats[f + SIZES] - math.sqrt(x * x + z * z)
    fa, side, angle = int(floats[rec + LINE_A]), floats[rec + SIGN], floats[rec + LINE_A + 2]
    size = smaller(floats, ints, int(floats[rec + SHAPE_A]), m)
    if floats[rec + KIND] != ON_RIM:
        fb, s, sign = int(floats[rec + OWN_B]), floats[rec + OWN_B + 1], floats[rec + OWN_B + 2]
        nx, ny, nz, along, out, _ = normal_across(
            floats, a, b, fa, side, angle, fb, sign, s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        )
        _, _, _, gx, gy, gz, _, _, _ = rim(floats, b, fb, sign, s)
        kx, ky, kz = turned(floats, b + AT_TURN, *out_of(floats, fb, 0.0, sign, 0.0))
        return size * min(along, out, -dot(nx, ny, nz, gx, gy, gz), -dot(nx, ny, nz, kx, ky, kz))
    ox, oy, oz = three(floats, rec + OWN_B)
    lx, ly, lz = three(floats, rec + LINE_B)
    s = floats[rec + LINE_A + 1]
    nx, ny, nz, along, out, _ = normal_across(floats, a, b, fa, side, angle, -1, 0.0, s, ox, oy, oz, lx, ly, lz)
    x, y, z = three(floats, rec + POINT)
    cx, cy, cz = three(floats, b + AT_X)
    x, y, z = own(floats, b, x - cx, y - cy, z - cz)
    nx, ny, nz = own(floats, b, -nx, -ny, -nz)
    on_edge = inside_edge(floats, ints, core_at(ints, m), int(floats[rec + OF]), size, nx, ny, nz, x, y, z)
    return min(on_edge, size * along, size * out)
