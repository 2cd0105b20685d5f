# mypy: ignore-errors
"""Which features of two polyhedra, balls or planes a contact is of, by the points where it was found."""

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_X, cross, put
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
from sceneql.contacts.rigid_exact.contact_kernels import (
    CORNER_EDGE,
    CORNER_FACE,
    CORNERS,
    EDGE_CORNER,
    EDGES,
    FACE_CORNER,
    LINE_A,
    LINE_B,
    NORMAL,
    OF,
    OWN_A,
    OWN_B,
    PAIR,
    RADIUS_A,
    RADIUS_B,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    dot,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import KIND as WHICH
from sceneql.contacts.rigid_exact.curved_contact_kernels import own
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    SHAPES_AT,
    mover_at,
)
from sceneql.contacts.rigid_exact.features_kernels import (
    FEATURE,
    face_of,
    line_of,
)
from sceneql.system.signatures_kernels import A, F, I, N

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
