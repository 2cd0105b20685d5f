# mypy: ignore-errors
"""Where rims of columns meet sharp edges, other rims and the flat ends of columns."""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import put, turned
from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.core_kernels import FLOATS
from sceneql.contacts.rigid_exact.contact_kernels import LINE_A, LINE_B, OF, OWN_B, RECORD, SHAPE_A, SHAPE_B, SIGN, dot
from sceneql.contacts.rigid_exact.curved import CENTER, COLUMN, FORM, SIZES
from sceneql.contacts.rigid_exact.curved_contact_kernels import FLAT, ON_FACE, ON_RIMS, own
from sceneql.contacts.rigid_exact.curved_find_kernels import (
    COLUMN_B,
    FIRST,
    FOUND,
    LEAST,
    MOVER_A,
    MOVER_B,
    SECOND,
    SHAPE_OF_A,
    begin_record,
    goes_away,
    in_axes_of_a,
)
from sceneql.contacts.rigid_exact.curved_surface_kernels import away, into, out_of, slant
from sceneql.contacts.rigid_exact.rim_crossing_kernels import crossing, normal_across, rim
from sceneql.contacts.rigid_exact.rim_kernels import on_circle
from sceneql.system.signatures_kernels import A, F, I, N

CLOSE = 1e-2
"""Distance from a rim, in parts of the column's radius, up to which what is sharp meets it as a curve."""
POINTS_OF_RIM, NARROWINGS = 24, 40
"""Points of a rim whose distance is asked for, and how often the place of the least is narrowed by a third."""


@lean(types.UniTuple(F, 3)(A, N, F, F, F, F))
def beside_rim(floats, f, x, y, z, gap):
    """Whether a place of a column's axes, at this distance, is beside a rim (1) or over a flat end (2), else 0; then
    which rim or end (-1, 1), and the place's angle."""
    x, y, z = into(floats, f, x - floats[f + CENTER], y - floats[f + CENTER + 1], z - floats[f + CENTER + 2])
    close = CLOSE * floats[f + SIZES]
    out, over = math.sqrt(x * x + z * z) - floats[f + SIZES], abs(y) - floats[f + SIZES + 1]
    side, angle = math.copysign(1.0, y), math.atan2(z, x)
    if gap <= close and min(out, over) >= -close:
        return 1.0, side, angle
    return (2.0 if over > out else 0.0), side, angle


@lean(types.UniTuple(F, 4)(A, I, N, N, N, N, N, F, F, F, F, F, F, F, F))
def rim_on_edge(floats, ints, fa, sb, edge, ma, mb, gap, s, ox, oy, oz, lx, ly, lz):
    """The contact of a column with a sharp edge of b, from o along the unit vector l, of which the place at the length
    s is the nearest and has this distance: which rim (0: none is met), the angle, the length, and the gap."""
    px, py, pz = in_axes_of_a(floats, ma, mb, ox + s * lx, oy + s * ly, oz + s * lz)
    where, side, angle = beside_rim(floats, fa, px, py, pz, gap)
    if where != 1.0:
        return 0.0, 0.0, 0.0, 0.0
    angle, s, found = crossing(floats, ma, mb, fa, side, angle, -1, 0.0, s, ox, oy, oz, lx, ly, lz)
    if found == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    nx, ny, nz, along, out, deep = normal_across(floats, ma, mb, fa, side, angle, -1, 0.0, s, ox, oy, oz, lx, ly, lz)
    nx, ny, nz = own(floats, ma, nx, ny, nz)
    if abs(deep) > CLOSE * floats[fa + SIZES] or min(along, out) < -LEAST:
        return 0.0, 0.0, 0.0, 0.0
    if not goes_away(floats, ints, sb, edge, ma, mb, nx, ny, nz):
        return 0.0, 0.0, 0.0, 0.0
    return side, angle, s, deep


@lean(F(A, I, N, F, F))
def rim_gap(floats, ints, who, sign, angle):
    """How far a point of a rim of the column b is from a."""
    ma, mb = ints[who + MOVER_A], ints[who + MOVER_B]
    p, q, r = on_circle(floats, ints[ints[who + COLUMN_B] + FLOATS], sign, math.cos(angle), math.sin(angle))
    x, y, z = in_axes_of_a(floats, ma, mb, p, q, r)
    return away(floats, ints, ints[ints[who + SHAPE_OF_A] + FLOATS], x, y, z)[0]


@lean(types.UniTuple(F, 3)(A, N, N, N, F, F, N, F, F))
def rim_on_rim(floats, ma, mb, fa, side, angle, fb, sign, s):
    """Both angles where two rims cross, from a guess, and their gap; infinity where they do not, or not outside."""
    angle, s, found = crossing(floats, ma, mb, fa, side, angle, fb, sign, s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if found == 0.0:
        return angle, s, math.inf
    nx, ny, nz, along, out, deep = normal_across(
        floats, ma, mb, fa, side, angle, fb, sign, s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    )
    _, _, _, gx, gy, gz, _, _, _ = rim(floats, mb, fb, sign, s)
    kx, ky, kz = turned(floats, mb + AT_TURN, *out_of(floats, fb, 0.0, sign, 0.0))
    least = min(along, out, -dot(nx, ny, nz, gx, gy, gz), -dot(nx, ny, nz, kx, ky, kz))
    if least < -LEAST or abs(deep) > CLOSE * floats[fa + SIZES]:
        return angle, s, math.inf
    return angle, s, deep


@lean(types.void(A, I, N, N, N))
def begin_swapped(floats, ints, rec, who, fb):
    """Begin the contact of b, a column, on a flat end of a: with b first."""
    begin_record(floats, ints, rec, who, ON_FACE, 0.0, fb)
    first = floats[rec + SHAPE_A]
    floats[rec + SHAPE_A], floats[rec + SHAPE_B] = floats[rec + SHAPE_B], first


@lean(FOUND)
def meet_rims(floats, ints, who, margin, next, most):
    """As `meet`, of the rims of a column b with a: with the rims of a column a, and its flat ends.

    Rims that touch other bodies, or lie flat, have a gap and no contact.
    """
    least, count = math.inf, 0
    step = 2.0 * math.pi / POINTS_OF_RIM
    ma, mb = ints[who + MOVER_A], ints[who + MOVER_B]
    fa, fb = ints[ints[who + SHAPE_OF_A] + FLOATS], ints[ints[who + COLUMN_B] + FLOATS]
    for side in range(2):
        sign, best, at = (-1.0 if side == 1 else 1.0), math.inf, 0.0
        for k in range(POINTS_OF_RIM):
            gap = rim_gap(floats, ints, who, sign, step * k)
            if gap < best:
                best, at = gap, step * k
        low, high = at - step, at + step
        for _ in range(NARROWINGS):
            third = (high - low) / 3.0
            if rim_gap(floats, ints, who, sign, low + third) < rim_gap(floats, ints, who, sign, high - third):
                high -= third
            else:
                low += third
        s = 0.5 * (low + high)
        best = min(best, rim_gap(floats, ints, who, sign, s))
        if floats[fa + FORM] == COLUMN and count <= most:
            x, y, z = in_axes_of_a(floats, ma, mb, *on_circle(floats, fb, sign, math.cos(s), math.sin(s)))
            where, end, angle = beside_rim(floats, fa, x, y, z, best)
            if where == 1.0:
                angle, s, gap = rim_on_rim(floats, ma, mb, fa, end, angle, fb, sign, s)
                if gap < math.inf:
                    best = gap
                    if gap <= margin and most > count and ints[who + FIRST] <= ints[who + SECOND]:  # not twice
                        rec = next + RECORD * count
                        begin_record(floats, ints, rec, who, ON_RIMS, 0.0, fa)
                        put(floats, rec + OWN_B, fb, s, sign)
                        floats[rec + SIGN], floats[rec + LINE_A + 2], floats[rec + OF] = end, angle, 0.0
                        count += 1
            elif where == 2.0 and best <= margin and most > count:
                nx, ny, nz = out_of(floats, fa, 0.0, end, 0.0)
                ux, uy, uz = turned(floats, ma + AT_TURN, nx, ny, nz)
                if slant(floats, fb, *own(floats, mb, ux, uy, uz)) > FLAT:
                    rec, half = next + RECORD * count, floats[fa + SIZES + 1]
                    begin_swapped(floats, ints, rec, who, fb)
                    put(floats, rec + LINE_B, nx, ny, nz)
                    px, py, pz = floats[fa + CENTER], floats[fa + CENTER + 1], floats[fa + CENTER + 2]
                    put(floats, rec + OWN_B, px + half * nx, py + half * ny, pz + half * nz)
                    floats[rec + SIGN], floats[rec + OF] = sign, 0.0
                    count += 1
        least = min(least, best)
    return count, least
