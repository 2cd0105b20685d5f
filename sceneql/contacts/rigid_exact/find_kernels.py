# mypy: ignore-errors
"""The contacts of a state: which features of two shapes touch, found once and then followed (contact_kernels)."""

import math

from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.tie_rows_kernels import AT_X, cross, put
from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import CORE, SHAPE
from sceneql.contacts.distance.core_kernels import (
    EDGES as EDGE_COUNT,
)
from sceneql.contacts.distance.core_kernels import (
    FACES,
    FLOATS,
    INTS,
    KIND,
    POINTS,
    RADIUS,
    REACH,
    VERTICES,
    edges_at,
)
from sceneql.contacts.distance.manifold_kernels import POINT as CORNER
from sceneql.contacts.distance.manifold_kernels import manifold
from sceneql.contacts.rigid_exact.contact_kernels import (
    ALONG,
    CORNER_EDGE,
    CORNER_FACE,
    CORNERS,
    EDGE_CORNER,
    EDGES,
    EXTENT,
    FACE_CORNER,
    FAST,
    FORCE,
    GAP,
    LINE_A,
    LINE_B,
    NORMAL,
    OF,
    OWN_A,
    OWN_B,
    PAIR,
    POINT,
    PUSHES,
    RADIUS_A,
    RADIUS_B,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    SLIDE,
    SLIDES,
    SLIP,
    SLOW,
    dot,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import KIND as WHICH
from sceneql.contacts.rigid_exact.curved import ELLIPSOID, FORM
from sceneql.contacts.rigid_exact.curved_contact_kernels import follow, own
from sceneql.contacts.rigid_exact.curved_find_kernels import ask, is_curved, meet_ahead
from sceneql.contacts.rigid_exact.exact_hold_kernels import CREEP, still
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    BEGUN,
    BEGUN_AT,
    CROWDED,
    KEPT,
    KEPT_AT,
    MEMORY_AT,
    MOST,
    PAIRS,
    PAIRS_AT,
    PLACE,
    PLACES_AT,
    RECORDS_AT,
    ROOM,
    ROOM_AT,
    SHAPES_AT,
    SINCE,
    UNDECIDED,
    follow_all,
    look,
    mover_at,
    put_places,
)
from sceneql.contacts.rigid_exact.features_kernels import (
    FEATURE,
    extent,
    face_of,
    line_of,
    meet_ball,
    smaller,
    solid_side,
)
from sceneql.system.signatures_kernels import A, F, I, N

TOUCHES = 1e-10
"""Gap, in parts of the size of the smaller body, up to which shapes touch."""
DEEP = 1e-3
"""Overlap, in the same parts, up to which a point is a contact: a step's error leaves far less."""
SLACK = 1e-4
"""Gap, in the same parts, up to which a contact that pushed still is one: what a step's error leaves is closed."""
PARALLEL = 1e-6
"""Sine of the angle of two edges up to which they have no normal."""


@lean(N(A, I, N, F, F, F))
def corner_at(floats, ints, shape, x, y, z):
    """The corner of a core at a point of its axes; -1 where none is."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    for k in range(ints[i + VERTICES]):
        p, q, r = three(floats, f + POINTS + 3 * k)
        if abs(p - x) + abs(q - y) + abs(r - z) <= FEATURE * floats[f + REACH]:
            return k
    return -1


@lean(N(A, I, N, F, F, F, F, F, F))
def face_at(floats, ints, shape, nx, ny, nz, x, y, z):
    """The face of a core with a normal and a point of its axes; -1 where none has both."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    best, found = 1.0 - FEATURE, -1
    for k in range(ints[i + FACES]):
        (p, q, r), (u, v, w) = face_of(floats, ints, shape, k)
        along = dot(p, q, r, nx, ny, nz)
        if along > best and abs(dot(p, q, r, x - u, y - v, z - w)) <= FEATURE * floats[f + REACH]:
            best, found = along, k
    return found


@lean(N(A, I, N, F, F, F))
def edge_at(floats, ints, shape, x, y, z):
    """The edge of a core at a point of its axes; -1 where none is."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    for k in range(ints[i + EDGE_COUNT]):
        e = edges_at(ints, i) + 4 * k
        p, q, r = three(floats, f + POINTS + 3 * ints[e])
        u, v, w = three(floats, f + POINTS + 3 * ints[e + 1])
        u, v, w, dx, dy, dz = u - p, v - q, w - r, x - p, y - q, z - r
        square = dot(u, v, w, u, v, w)
        if square == 0.0:
            continue
        part = min(1.0, max(0.0, dot(u, v, w, dx, dy, dz) / square))
        away = abs(dx - part * u) + abs(dy - part * v) + abs(dz - part * w)
        if away <= FEATURE * floats[f + REACH]:
            return k
    return -1


@lean(types.void(A, I, N, N, N, N, F, F, F, F, F, F, F, F, F))
def name(floats, ints, rec, pair, a, b, ax, ay, az, bx, by, bz, nx, ny, nz):
    """Write what a contact is, by the points of two shapes and the normal, in the world."""
    for c in range(RECORD):
        floats[rec + c] = 0.0
    sa, sb = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b
    ma, mb = mover_at(ints, a), mover_at(ints, b)
    flat = ints[sb + KIND] != CORE
    ra = floats[ints[sa + FLOATS] + RADIUS]
    rb = 0.0 if flat else floats[ints[sb + FLOATS] + RADIUS]
    floats[rec + RADIUS_A], floats[rec + RADIUS_B], floats[rec + SIGN], floats[rec + OF] = ra, rb, 1.0, -1.0
    floats[rec + SHAPE_A], floats[rec + SHAPE_B], floats[rec + PAIR] = a, b, pair
    put(floats, rec + NORMAL, nx, ny, nz)
    xa, ya, za = three(floats, ma + AT_X)
    xb, yb, zb = three(floats, mb + AT_X)
    pa = own(floats, ma, ax + ra * nx - xa, ay + ra * ny - ya, az + ra * nz - za)
    pb = own(floats, mb, bx - rb * nx - xb, by - rb * ny - yb, bz - rb * nz - zb)
    na, nb = own(floats, ma, -nx, -ny, -nz), own(floats, mb, nx, ny, nz)
    put(floats, rec + OWN_A, *pa)
    put(floats, rec + OWN_B, *pb)
    corner_a = corner_at(floats, ints, sa, *pa)
    if corner_a >= 0:
        put(floats, rec + OWN_A, *three(floats, ints[sa + FLOATS] + POINTS + 3 * corner_a))
    # Whatever is not said otherwise below: a point of a over the plane through b's point, across the normal.
    floats[rec + WHICH] = CORNER_FACE
    put(floats, rec + LINE_B, *nb)
    if flat:
        plane = ints[sb + FLOATS] + POINTS
        x, y, z = three(floats, plane)
        put(floats, rec + LINE_B, x, y, z)
        put(floats, rec + OWN_B, x * floats[plane + 3], y * floats[plane + 3], z * floats[plane + 3])
        return
    corner_b = corner_at(floats, ints, sb, *pb)
    face_a, face_b = face_at(floats, ints, sa, *na, *pa), face_at(floats, ints, sb, *nb, *pb)
    if corner_b >= 0:
        put(floats, rec + OWN_B, *three(floats, ints[sb + FLOATS] + POINTS + 3 * corner_b))
    if corner_a >= 0 and face_b >= 0:
        normal, corner = face_of(floats, ints, sb, face_b)
        put(floats, rec + LINE_B, *normal)
        put(floats, rec + OWN_B, *corner)
        return
    if corner_b >= 0 and face_a >= 0:
        normal, corner = face_of(floats, ints, sa, face_a)
        floats[rec + WHICH] = FACE_CORNER
        put(floats, rec + LINE_A, *normal)
        put(floats, rec + OWN_A, *corner)
        return
    if corner_a >= 0 and corner_b >= 0:
        if ra + rb > 0.0:
            floats[rec + WHICH] = CORNERS
        return
    edge_a, edge_b = edge_at(floats, ints, sa, *pa), edge_at(floats, ints, sb, *pb)
    if corner_a >= 0 and edge_b >= 0:
        if ra + rb > 0.0:
            line, end = line_of(floats, ints, sb, edge_b)
            floats[rec + WHICH] = CORNER_EDGE
            put(floats, rec + LINE_B, *line)
            put(floats, rec + OWN_B, *end)
        return
    if corner_b >= 0 and edge_a >= 0:
        if ra + rb > 0.0:
            line, end = line_of(floats, ints, sa, edge_a)
            floats[rec + WHICH] = EDGE_CORNER
            put(floats, rec + LINE_A, *line)
            put(floats, rec + OWN_A, *end)
        return
    if edge_a >= 0 and edge_b >= 0:
        one, end_a = line_of(floats, ints, sa, edge_a)
        other, end_b = line_of(floats, ints, sb, edge_b)
        # Both in the world, for their vector product.
        r, q = ma + AT_TURN, mb + AT_TURN
        ex = dot(*three(floats, r), *one)
        ey, ez = dot(*three(floats, r + 3), *one), dot(*three(floats, r + 6), *one)
        fx = dot(*three(floats, q), *other)
        fy, fz = dot(*three(floats, q + 3), *other), dot(*three(floats, q + 6), *other)
        cx, cy, cz = cross(ex, ey, ez, fx, fy, fz)
        along = dot(cx, cy, cz, nx, ny, nz)
        if abs(along) > PARALLEL:
            floats[rec + WHICH] = EDGES
            floats[rec + SIGN] = 1.0 if along > 0.0 else -1.0
            put(floats, rec + LINE_A, *one)
            put(floats, rec + LINE_B, *other)
            put(floats, rec + OWN_A, *end_a)
            put(floats, rec + OWN_B, *end_b)


@lean(N(A, I, N, N, N, N, F))
def carried(floats, ints, a, b, pair, before, margin):
    """The contact of a ball or an ellipsoid on a polyhedron, of which each change is an event; -1 for others."""
    sa, sb = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b
    curved = is_curved(ints, sa) and floats[ints[sa + FLOATS] + FORM] == ELLIPSOID and ints[sb + KIND] == CORE
    found = -1
    if not curved and solid_side(ints, a, b) < 0:
        return found
    for j in range(before):
        old = ints[RECORDS_AT] + RECORD * j
        if floats[old + PAIR] == pair:
            if found >= 0 or floats[old + OF] < 0.0:
                return -1
            found = old
    if found >= 0 and not -DEEP * smaller(floats, ints, a, b) - margin <= floats[found + GAP] <= margin:
        found = -1
    return found


@lean(types.boolean(F, A, A, I, A, I, types.boolean))
def find(t, y, floats, ints, points, names, goes_on):
    """Write the contacts of all pairs that touch, as kept; whether they are those of before.

    Which of them slide is by their speeds. ``points``, ``names``: room of a manifold; ``goes_on``: no event is here.
    """
    memory = ints[MEMORY_AT]
    look(t, y, floats, ints)
    put_places(y, floats, ints, ints[PLACES_AT])
    follow_all(floats, ints)
    before, most, same = int(floats[memory + KEPT]), ints[MOST], 0
    count, next = 0, ints[RECORDS_AT] + RECORD * most
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    for pair in range(ints[PAIRS]):
        a, b = ints[ints[PAIRS_AT] + 2 * pair], ints[ints[PAIRS_AT] + 2 * pair + 1]
        margin = TOUCHES * smaller(floats, ints, a, b)
        for c in range(3):
            margin += 1e-14 * (abs(floats[mover_at(ints, a) + AT_X + c]) + abs(floats[mover_at(ints, b) + AT_X + c]))
        open = 0.0
        for j in range(before):
            old = ints[RECORDS_AT] + RECORD * j
            if floats[old + PAIR] == pair and floats[old + PUSHES] > 0.0:
                open = max(open, floats[old + GAP])
        margin += min(open, SLACK * smaller(floats, ints, a, b))
        sa, sb, at = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b, ints[PLACES_AT]
        old = carried(floats, ints, a, b, pair, before, margin) if goes_on else -1
        if old >= 0 and count < most:
            for c in range(RECORD):
                floats[next + RECORD * count + c] = floats[old + c]
            count, same = count + 1, same + 1
            continue
        if is_curved(ints, sa):
            who = ask(ints, pair, a, b, mover_at(ints, a), mover_at(ints, b))
            count += meet_ahead(floats, ints, who, margin, next + RECORD * count, most - count)
            continue
        found, _, nx, ny, nz = manifold(
            floats, ints, sa, sb, floats, at + PLACE * a, at + PLACE * b, margin, points, names, room
        )
        side = solid_side(ints, a, b)
        for k in range(found if side < 0 else min(found, 1)):
            p, rec = CORNER * k, next + RECORD * count
            if points[p + 6] > margin or points[p + 6] < -DEEP * smaller(floats, ints, a, b) - margin:
                continue
            if count == most:
                floats[memory + CROWDED] += 1.0
                continue
            if side >= 0:
                meet_ball(floats, ints, rec, pair, a, b, side)
            else:
                name(floats, ints, rec, pair, a, b, *three(points, p), *three(points, p + 3), nx, ny, nz)
                follow(floats, ints, rec, mover_at(ints, a), mover_at(ints, b))
            count += 1
    for k in range(count):
        rec = next + RECORD * k
        for j in range(before):
            old = ints[RECORDS_AT] + RECORD * j
            if floats[old + PAIR] != floats[rec + PAIR]:
                continue
            away = 0.0
            for c in range(3):
                away = max(away, abs(floats[old + POINT + c] - floats[rec + POINT + c]))
            reach = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
            # What is round may roll far in a step.
            rolled = floats[rec + OF] >= 0.0 and floats[old + OF] >= 0.0
            if away <= 1e-3 * reach or (rolled and floats[old + SIGN] == floats[rec + SIGN]):
                for c in range(3):
                    floats[rec + FORCE + c] = floats[old + FORCE + c]
                    floats[rec + ALONG + c] = floats[old + ALONG + c]
                floats[rec + PUSHES] = floats[old + PUSHES]
    for c in range(RECORD * count):
        floats[ints[RECORDS_AT] + c] = floats[next + c]
    floats[memory + KEPT] = count
    return same == before and count == before


@lean(types.void(F, A, A, I, types.boolean))
def begin(t, y, floats, ints, same):
    """Mark the contacts that are kept from a time on, open as to which slide or leave; ``same``: as before."""
    memory = ints[MEMORY_AT]
    for pair in range(ints[PAIRS]):
        floats[ints[KEPT_AT] + pair] = 0.0
    for k in range(int(floats[memory + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        floats[ints[KEPT_AT] + int(floats[rec + PAIR])] += 1.0
        sx, sy, sz = three(floats, rec + SLIDE)
        slip = math.sqrt(sx * sx + sy * sy + sz * sz)
        slides = slip > still(floats, ints, rec)
        same = same and (slip > CREEP) == (floats[rec + SLIDES] == FAST)
        floats[rec + SLIDES] = (FAST if slip > CREEP else SLOW) if slides else 0.0
        floats[rec + SLIP] = slip if slides else 0.0
        if slides:
            put(floats, rec + ALONG, sx / slip, sy / slip, sz / slip)
        inside = extent(floats, ints, rec)
        # (From where it began, so that what creeps over a border is told.)
        floats[rec + EXTENT] = max(inside, floats[rec + EXTENT]) if floats[rec + OF] >= 0.0 else inside
    floats[memory + UNDECIDED] = 1.0
    if not same:
        floats[memory + SINCE] = t


@lean(types.void(F, A, A, I))
def start_step(t, y, floats, ints):
    """Keep where the shapes are at the start of a step."""
    look(t, y, floats, ints)
    put_places(y, floats, ints, ints[BEGUN_AT])
    floats[ints[MEMORY_AT] + BEGUN] = t
