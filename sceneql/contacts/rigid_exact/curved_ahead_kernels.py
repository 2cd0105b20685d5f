# mypy: ignore-errors
"""Contacts of a curved body on the border of two features, by that to which it moves; and which are not found."""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_X, put
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.convex import CORE
from sceneql.contacts.distance.core_kernels import (
    EDGES,
    FLOATS,
    INTS,
    KIND,
    POINTS,
    RADIUS,
    REACH,
    VERTICES,
    edges_at,
)
from sceneql.contacts.rigid_exact.contact_kernels import (
    DRIFT,
    OF,
    POINT,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import KIND as WHICH
from sceneql.contacts.rigid_exact.curved import CENTER, COLUMN, FORM, RING, SIZES
from sceneql.contacts.rigid_exact.curved_contact_kernels import ON_FACE, follow, speed_at
from sceneql.contacts.rigid_exact.curved_find_kernels import (
    COLUMN_B,
    FIRST,
    LEAST,
    MOVER_A,
    MOVER_B,
    SECOND,
    SHAPE_OF_A,
    SHAPE_OF_B,
    in_axes_of_a,
    is_plain,
    slope_along,
)
from sceneql.contacts.rigid_exact.curved_meet_kernels import meet
from sceneql.contacts.rigid_exact.curved_surface_kernels import into
from sceneql.contacts.rigid_exact.exact_rows_kernels import mover_at
from sceneql.contacts.rigid_exact.features_kernels import AHEAD, LIMIT, extent, smaller, way_ahead
from sceneql.system.signatures_kernels import A, F, I, N

APART = 1e-4
"""Distance of two contacts, in parts of the smaller body, up to which they are one, on the border of two features."""
FLUSH = 1e-9
"""Distance, in parts of a column's size, up to which an edge lies in its flat end."""
CUT, CUTS = 1e-5, 64
"""Depth, in parts of the smaller body, from which an edge is in a ring or column; places on the edge that are asked."""


@lean_inlined
def follow_own(floats, ints, rec):
    """Follow a contact with its own movers: of two columns it may be that of the second with the first."""
    a, b = int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B])
    follow(floats, ints, rec, mover_at(ints, a), mover_at(ints, b))


@lean(N(A, I, N, N, N))
def stay(floats, ints, who, next, count):
    """Drop the points of a circle that lies flat which leave their face now; how many stay."""
    ma, mb, kept = ints[who + MOVER_A], ints[who + MOVER_B], 0
    size = smaller(floats, ints, ints[who + FIRST], ints[who + SECOND])
    px, py, pz = three(floats, ma + AT_X)
    for k in range(count):
        rec, to = next + RECORD * k, next + RECORD * kept
        if floats[rec + OF] < 0.0 and extent(floats, ints, rec) < LIMIT * size:
            x, y, z = three(floats, rec + POINT)
            ux, uy, uz = speed_at(floats, ma, x, y, z)
            vx, vy, vz = speed_at(floats, mb, x, y, z)
            dx, dy, dz = way_ahead(floats, ints, rec, ux - vx, uy - vy, uz - vz)
            put(floats, ma + AT_X, px + dx, py + dy, pz + dz)
            follow(floats, ints, rec, ma, mb)
            leaves = extent(floats, ints, rec) < -LIMIT * size
            put(floats, ma + AT_X, px, py, pz)
            follow(floats, ints, rec, ma, mb)
            if leaves:
                continue
        for c in range(RECORD if to != rec else 0):
            floats[to + c] = floats[rec + c]
        kept += 1
    return kept


@lean(N(A, I, N, F, N, N, N, N))
def roll_ahead(floats, ints, who, margin, next, count, most, k):
    """Of a column or ring at the border of a face, where its contact k is, the contacts to which it moves; how many."""
    ma, size = ints[who + MOVER_A], smaller(floats, ints, ints[who + FIRST], ints[who + SECOND])
    dx, dy, dz = way_ahead(floats, ints, next + RECORD * k, *three(floats, next + RECORD * k + DRIFT))
    x, y, z = three(floats, ma + AT_X)
    put(floats, ma + AT_X, x + dx, y + dy, z + dz)
    more = min(most, meet(floats, ints, who, margin + LEAST * AHEAD * size, next, most)[0])
    put(floats, ma + AT_X, x, y, z)
    if more == 0:
        more = min(count, meet(floats, ints, who, margin, next, most)[0])
    for j in range(more):
        follow_own(floats, ints, next + RECORD * j)
    return more


@lean_inlined
def beside(floats, f, x, y, z):
    """How far a place of a column's axes is outside its round side, and above its flat ends."""
    x, y, z = into(floats, f, x - floats[f + CENTER], y - floats[f + CENTER + 1], z - floats[f + CENTER + 2])
    return math.sqrt(x * x + z * z) - floats[f + SIZES], abs(y) - floats[f + SIZES + 1]


@lean(types.boolean(A, I, N))
def is_cut(floats, ints, who):
    """Whether an edge of b is in a ring or a column, or lies across a flat end of it from beside it, as where these lie
    on it flat: which is not found as a contact."""
    sb, ma, mb = ints[who + SHAPE_OF_B], ints[who + MOVER_A], ints[who + MOVER_B]
    fa, fb, ib = ints[ints[who + SHAPE_OF_A] + FLOATS], ints[sb + FLOATS], ints[sb + INTS]
    form = floats[fa + FORM]
    if (form != RING and form != COLUMN) or ints[sb + KIND] != CORE or ints[who + COLUMN_B] >= 0:
        return False
    deep = floats[fb + RADIUS] - CUT * smaller(floats, ints, ints[who + FIRST], ints[who + SECOND])
    for e in range(ints[ib + EDGES]):
        edge = edges_at(ints, ib) + 4 * e
        x, y, z = in_axes_of_a(floats, ma, mb, *three(floats, fb + POINTS + 3 * ints[edge]))
        ux, uy, uz = in_axes_of_a(floats, ma, mb, *three(floats, fb + POINTS + 3 * ints[edge + 1]))
        ux, uy, uz = ux - x, uy - y, uz - z
        within = beyond = False
        for piece in range(CUTS + 1):
            part = piece / CUTS
            if slope_along(floats, ints, fa, x, y, z, ux, uy, uz, part)[0] < deep:
                return True
            out, over = beside(floats, fa, x + part * ux, y + part * uy, z + part * uz)
            within = within or (abs(over) <= FLUSH * floats[fa + REACH] and out < -CUT * floats[fa + REACH])
            beyond = beyond or (abs(over) <= FLUSH * floats[fa + REACH] and out > CUT * floats[fa + REACH])
        if within and beyond and form == COLUMN:
            return True
    return False


@lean(N(A, I, N, F, N, N))
def meet_ahead(floats, ints, who, margin, next, most):
    """As `meet`, with the contacts followed; of one on the border of two features that to which it moves; how many."""
    ma, sb = ints[who + MOVER_A], ints[who + SHAPE_OF_B]
    count = meet(floats, ints, who, margin, next, most)[0]
    for k in range(count):
        follow_own(floats, ints, next + RECORD * k)
    if count == 0 or ints[sb + KIND] != CORE or ints[ints[sb + INTS] + VERTICES] == 1:
        return count
    size = smaller(floats, ints, ints[who + FIRST], ints[who + SECOND])
    if not is_plain(floats, ints, ints[who + FIRST]):
        for k in range(count):
            rec = next + RECORD * k
            if floats[rec + WHICH] == ON_FACE and extent(floats, ints, rec) < LIMIT * size:
                return roll_ahead(floats, ints, who, margin, next, count, most, k)
        return stay(floats, ints, who, next, count)
    for k in range(count):
        for c in range(3):
            if abs(floats[next + RECORD * k + POINT + c] - floats[next + POINT + c]) > APART * size:
                return count
    dx, dy, dz = way_ahead(floats, ints, next, *three(floats, next + DRIFT))
    x, y, z = three(floats, ma + AT_X)
    put(floats, ma + AT_X, x + dx, y + dy, z + dz)
    more = meet(floats, ints, who, margin + LEAST * AHEAD * size, next, 1)[0]
    if more == 0:
        put(floats, ma + AT_X, x, y, z)
        more = min(1, meet(floats, ints, who, margin, next, most)[0])
    put(floats, ma + AT_X, x, y, z)
    follow_own(floats, ints, next)
    return more
