# mypy: ignore-errors
"""Which face, edge or corner of a polyhedron a ball or a curved body touches, and how far it is from leaving it.

What rolls from a face to an edge is at their border for an instant: the feature is then that to which it moves.
"""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_V, AT_W, AT_X, put, turned
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import CORE, SHAPE
from sceneql.contacts.distance.core_kernels import EDGES as EDGE_COUNT
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
    loop_at,
)
from sceneql.contacts.distance.first_touch_kernels import move
from sceneql.contacts.rigid_exact.contact_kernels import (
    CORNER_EDGE,
    CORNER_FACE,
    CORNERS,
    EDGE_CORNER,
    EDGES,
    EXTENT,
    FACE_CORNER,
    LINE_A,
    LINE_B,
    NORMAL,
    OF,
    OWN_A,
    OWN_B,
    PAIR,
    POINT,
    RADIUS_A,
    RADIUS_B,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SIGN,
    dot,
    pace,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import KIND as WHICH
from sceneql.contacts.rigid_exact.curved import CURVED
from sceneql.contacts.rigid_exact.curved_contact_kernels import (
    ON_CORNER,
    ON_EDGE,
    ON_FACE,
    ON_RIM,
    follow,
    own,
    speed_at,
)
from sceneql.contacts.rigid_exact.exact_rows_kernels import PLACE, PLACES_AT, SHAPES_AT, core_at, mover_at
from sceneql.contacts.rigid_exact.stop_kernels import SIZE, STOP
from sceneql.system.signatures_kernels import A, F, I, N

inside_round = lazy("sceneql.contacts.rigid_exact.rim_crossing_kernels:inside_round", F(A, I, N))
FEATURE = 1e-7
"""Distance from a feature, in parts of the body's size, up to which a point is on it."""
AHEAD = 1e-6
"""How far on its way a body is, in parts of the size of the smaller one, where it is asked which feature it touches."""
FAR = 10.0
"""Of polyhedra at least so many times FEATURE."""
LIMIT = 1e-7
"""How far inside its feature a contact is, in parts of the smaller body, up to which it is at the end of it."""
FACE, EDGE, VERTEX = range(3)


@lean_inlined
def face_of(floats, ints, shape, k):
    """The normal of a face of a core, and a corner of it."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    first, _ = loop_at(ints, i, k)
    return three(floats, f + POINTS + 3 * (ints[i + VERTICES] + k)), three(floats, f + POINTS + 3 * ints[first])


@lean_inlined
def line_of(floats, ints, shape, k):
    """The unit direction of an edge of a core, and one of its ends."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    e = edges_at(ints, i) + 4 * k
    p, q, r = three(floats, f + POINTS + 3 * ints[e])
    u, v, w = three(floats, f + POINTS + 3 * ints[e + 1])
    u, v, w = u - p, v - q, w - r
    length = math.sqrt(dot(u, v, w, u, v, w))
    return (u / length, v / length, w / length), (p, q, r)


@lean_inlined
def smaller(floats, ints, a, b):
    """The reach of the smaller of two shapes."""
    fa, fb = ints[ints[SHAPES_AT] + SHAPE * a + FLOATS], ints[ints[SHAPES_AT] + SHAPE * b + FLOATS]
    return min(floats[fa + REACH], floats[fb + REACH])


@lean_inlined
def size_at(floats, ints, rec):
    """The size against which the gap of a contact is small: of a stop that of its tie's motion."""
    if floats[rec + WHICH] == STOP:
        return floats[int(floats[rec + OWN_A]) + SIZE]
    return smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))


@lean(N(I, N, N))
def solid_side(ints, a, b):
    """Of a ball and a polyhedron, which is the latter: 0 or 1; -1 for other pairs."""
    sa, sb = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b
    if ints[sa + KIND] != CORE or ints[sb + KIND] != CORE:
        return -1
    of_a, of_b = ints[ints[sa + INTS] + VERTICES], ints[ints[sb + INTS] + VERTICES]
    if (of_a == 1) == (of_b == 1):
        return -1
    return 0 if of_b == 1 else 1


@lean(types.Tuple((N, N))(A, I, N, F, F, F))
def nearest_feature(floats, ints, shape, x, y, z):
    """The feature of a polyhedron that is the nearest to a point of its axes outside: its kind and its number."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    faces = ints[i + FACES]
    most, behind = -math.inf, 0
    for k in range(faces):
        (p, q, r), (u, v, w) = face_of(floats, ints, shape, k)
        high = dot(p, q, r, x - u, y - v, z - w)
        if high > most:
            most, behind = high, k
        if high < 0.0:
            continue
        over, tx, ty, tz = True, x - high * p, y - high * q, z - high * r
        for j in range(faces):
            (p, q, r), (u, v, w) = face_of(floats, ints, shape, j)
            over = over and (j == k or dot(p, q, r, tx - u, ty - v, tz - w) <= 0.0)
        if over:
            return FACE, k
    if faces > 0 and most < 0.0:
        return FACE, behind
    best, kind, found = math.inf, VERTEX, 0
    for k in range(ints[i + VERTICES]):
        u, v, w = three(floats, f + POINTS + 3 * k)
        square = (x - u) ** 2 + (y - v) ** 2 + (z - w) ** 2
        if square < best:
            best, found = square, k
    for k in range(ints[i + EDGE_COUNT]):
        e = edges_at(ints, i) + 4 * k
        p, q, r = three(floats, f + POINTS + 3 * ints[e])
        u, v, w = three(floats, f + POINTS + 3 * ints[e + 1])
        u, v, w, tx, ty, tz = u - p, v - q, w - r, x - p, y - q, z - r
        part, whole = dot(u, v, w, tx, ty, tz), dot(u, v, w, u, v, w)
        if part <= 0.0 or part >= whole:
            continue
        part /= whole
        square = (tx - part * u) ** 2 + (ty - part * v) ** 2 + (tz - part * w) ** 2
        if square < best:
            best, kind, found = square, EDGE, k
    return kind, found


@lean(types.void(A, I, N, N, N, N, N))
def write_ball(floats, ints, rec, pair, a, b, side):
    """Write the contact of a ball with the feature of a polyhedron, which is a (side 0) or b, that is the nearest."""
    for c in range(RECORD):
        floats[rec + c] = 0.0
    solid, ball = (a, b) if side == 0 else (b, a)
    ss, sb = ints[SHAPES_AT] + SHAPE * solid, ints[SHAPES_AT] + SHAPE * ball
    ms, mb = mover_at(ints, solid), mover_at(ints, ball)
    floats[rec + SHAPE_A], floats[rec + SHAPE_B], floats[rec + PAIR], floats[rec + SIGN] = a, b, pair, 1.0
    floats[rec + RADIUS_A] = floats[ints[ints[SHAPES_AT] + SHAPE * a + FLOATS] + RADIUS]
    floats[rec + RADIUS_B] = floats[ints[ints[SHAPES_AT] + SHAPE * b + FLOATS] + RADIUS]
    x, y, z = three(floats, ints[sb + FLOATS] + POINTS)
    put(floats, rec + (OWN_B if side == 0 else OWN_A), x, y, z)
    x, y, z = turned(floats, mb + AT_TURN, x, y, z)
    px, py, pz = three(floats, mb + AT_X)
    qx, qy, qz = three(floats, ms + AT_X)
    x, y, z = own(floats, ms, px + x - qx, py + y - qy, pz + z - qz)
    kind, of = nearest_feature(floats, ints, ss, x, y, z)
    line, there = rec + (LINE_A if side == 0 else LINE_B), rec + (OWN_A if side == 0 else OWN_B)
    floats[rec + OF], floats[rec + EXTENT] = of, -math.inf
    if kind == FACE:
        floats[rec + WHICH] = FACE_CORNER if side == 0 else CORNER_FACE
        normal, corner = face_of(floats, ints, ss, of)
        put(floats, line, *normal)
        put(floats, there, *corner)
    elif kind == EDGE:
        floats[rec + WHICH] = EDGE_CORNER if side == 0 else CORNER_EDGE
        along, end = line_of(floats, ints, ss, of)
        put(floats, line, *along)
        put(floats, there, *end)
    else:
        floats[rec + WHICH] = CORNERS
        put(floats, there, *three(floats, ints[ss + FLOATS] + POINTS + 3 * of))


@lean(types.UniTuple(F, 3)(A, I, N, F, F, F))
def way_ahead(floats, ints, rec, ux, uy, uz):
    """A short way across the normal of a contact, along a velocity; 0 where this is rounding."""
    a, b = int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B])
    nx, ny, nz = three(floats, rec + NORMAL)
    part = dot(nx, ny, nz, ux, uy, uz)
    ux, uy, uz = ux - part * nx, uy - part * ny, uz - part * nz
    speed = math.sqrt(ux * ux + uy * uy + uz * uz)
    if not speed > 1e-12 * pace(floats, rec, mover_at(ints, a), mover_at(ints, b)):
        return 0.0, 0.0, 0.0
    by = AHEAD * smaller(floats, ints, a, b) / speed
    return by * ux, by * uy, by * uz


@lean(types.void(A, I, N, N, N, N, N))
def meet_ball(floats, ints, rec, pair, a, b, side):
    """Write the contact of a ball and a polyhedron that touch: with the feature that the ball is at, or moves to."""
    ma, mb = mover_at(ints, a), mover_at(ints, b)
    write_ball(floats, ints, rec, pair, a, b, side)
    follow(floats, ints, rec, ma, mb)
    ball, solid = (mb, ma) if side == 0 else (ma, mb)
    x, y, z = three(floats, ball + AT_X)
    core = rec + (OWN_B if side == 0 else OWN_A)
    p, q, r = turned(floats, ball + AT_TURN, *three(floats, core))
    ux, uy, uz = speed_at(floats, ball, x + p, y + q, z + r)
    vx, vy, vz = speed_at(floats, solid, x + p, y + q, z + r)
    dx, dy, dz = way_ahead(floats, ints, rec, ux - vx, uy - vy, uz - vz)
    if dx != 0.0 or dy != 0.0 or dz != 0.0:
        put(floats, ball + AT_X, x + dx, y + dy, z + dz)
        write_ball(floats, ints, rec, pair, a, b, side)
        put(floats, ball + AT_X, x, y, z)
        follow(floats, ints, rec, ma, mb)


@lean(F(A, I, N, N, F, F, F))
def inside_face(floats, ints, shape, line, x, y, z):
    """How far a point is within the face whose normal stands at floats[line:]."""
    least, on = math.inf, False
    for k in range(ints[ints[shape + INTS] + FACES]):
        (p, q, r), (u, v, w) = face_of(floats, ints, shape, k)
        if dot(p, q, r, *three(floats, line)) > 1.0 - FEATURE:
            on = True
        else:
            least = min(least, dot(p, q, r, u - x, v - y, w - z))
    return least if on else math.inf


@lean(F(A, I, N, N, F, F, F, F))
def inside_wedge(floats, ints, shape, k, size, nx, ny, nz):
    """How far the normal n is from those of the faces of an edge, times ``size``."""
    e, least = edges_at(ints, ints[shape + INTS]) + 4 * k, math.inf
    if ints[e + 2] >= 0 and ints[e + 3] >= 0:
        one, _ = face_of(floats, ints, shape, ints[e + 2])
        other, _ = face_of(floats, ints, shape, ints[e + 3])
        both = dot(one[0], one[1], one[2], other[0], other[1], other[2])
        s, t = dot(one[0], one[1], one[2], nx, ny, nz), dot(other[0], other[1], other[2], nx, ny, nz)
        by = size / math.sqrt(max(1e-300, 1.0 - both * both))
        least = min(least, by * (t - both * s), by * (s - both * t))
    return least


@lean(F(A, I, N, N, F, F, F, F, F, F, F))
def inside_edge(floats, ints, shape, k, size, nx, ny, nz, x, y, z):
    """How far a point is from the ends of an edge, or the normal n from those of its faces, times ``size``."""
    f, e = ints[shape + FLOATS], edges_at(ints, ints[shape + INTS]) + 4 * k
    p, q, r = three(floats, f + POINTS + 3 * ints[e])
    u, v, w = three(floats, f + POINTS + 3 * ints[e + 1])
    u, v, w = u - p, v - q, w - r
    length = math.sqrt(dot(u, v, w, u, v, w))
    s = dot(u, v, w, x - p, y - q, z - r) / length
    return min(s, length - s, inside_wedge(floats, ints, shape, k, size, nx, ny, nz))


@lean(F(A, I, N, N, F, F, F, F))
def inside_corner(floats, ints, shape, k, size, nx, ny, nz):
    """How far the normal n is from being across an edge of a corner, times ``size``."""
    least, i = math.inf, ints[shape + INTS]
    for j in range(ints[i + EDGE_COUNT]):
        e = edges_at(ints, i) + 4 * j
        if ints[e] == ints[e + 1] or (ints[e] != k and ints[e + 1] != k):
            continue
        (u, v, w), _ = line_of(floats, ints, shape, j)
        along = dot(u, v, w, nx, ny, nz)
        least = min(least, size * (-along if ints[e] == k else along))
    return least


@lean(F(A, I, N, N))
def inside_line(floats, ints, rec, side):
    """How far a contact of two edges is from the ends of that of a (side 0) or b."""
    m = int(floats[rec + SHAPE_A + side])
    shape, mover = ints[SHAPES_AT] + SHAPE * m, mover_at(ints, m)
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    end, line = rec + (OWN_A if side == 0 else OWN_B), rec + (LINE_A if side == 0 else LINE_B)
    x, y, z = three(floats, rec + POINT)
    cx, cy, cz = three(floats, mover + AT_X)
    x, y, z = own(floats, mover, x - cx, y - cy, z - cz)
    ex, ey, ez = three(floats, line)
    for k in range(ints[i + EDGE_COUNT]):
        e = edges_at(ints, i) + 4 * k
        p, q, r = three(floats, f + POINTS + 3 * ints[e])
        u, v, w = three(floats, f + POINTS + 3 * ints[e + 1])
        length = dot(ex, ey, ez, u - p, v - q, w - r)
        if p != floats[end] or q != floats[end + 1] or r != floats[end + 2]:
            continue
        if not length > (1.0 - FEATURE) * math.sqrt((u - p) ** 2 + (v - q) ** 2 + (w - r) ** 2):
            continue
        s = dot(ex, ey, ez, x - p, y - q, z - r)
        return min(s, length - s)
    return math.inf


@lean(F(A, I, N))
def extent(floats, ints, rec):
    """How far a contact is inside the feature that it is on: as far as it can go until it leaves it [m]; infinity
    where that is not known."""
    kind, of = int(floats[rec + WHICH]), int(floats[rec + OF])
    if kind == EDGES:
        return min(inside_line(floats, ints, rec, 0), inside_line(floats, ints, rec, 1))
    on_face, other = kind == CORNER_FACE or kind == FACE_CORNER or kind == ON_FACE, int(floats[rec + SHAPE_B])
    if kind >= ON_RIM or (kind == ON_FACE and ints[ints[SHAPES_AT] + SHAPE * other + KIND] == CURVED):
        return inside_round(floats, ints, rec)
    if not on_face and of < 0:
        return math.inf
    side = 0 if kind == FACE_CORNER or kind == EDGE_CORNER else 1
    beside = kind == EDGE_CORNER and ints[ints[SHAPES_AT] + SHAPE * int(floats[rec + SHAPE_A]) + KIND] == CURVED
    side = 1 if beside else side  # a column along an edge that ends there
    if kind == CORNERS:
        side = solid_side(ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
    m = int(floats[rec + SHAPE_A + side])
    shape, mover = core_at(ints, m), mover_at(ints, m)
    if ints[shape + KIND] != CORE:
        return math.inf
    x, y, z = three(floats, rec + POINT)
    cx, cy, cz = three(floats, mover + AT_X)
    x, y, z = own(floats, mover, x - cx, y - cy, z - cz)
    if on_face:
        return inside_face(floats, ints, shape, rec + (LINE_B if side == 1 else LINE_A), x, y, z)
    nx, ny, nz = own(floats, mover, *three(floats, rec + NORMAL))
    if side == 0:
        nx, ny, nz = -nx, -ny, -nz
    size = smaller(floats, ints, int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B]))
    if beside:
        return inside_wedge(floats, ints, shape, of, size, nx, ny, nz)
    if kind == CORNERS or kind == ON_CORNER:
        return inside_corner(floats, ints, shape, of, size, nx, ny, nz)
    if kind == CORNER_EDGE or kind == EDGE_CORNER or kind == ON_EDGE:
        return inside_edge(floats, ints, shape, of, size, nx, ny, nz, x, y, z)
    return math.inf


@lean(F(A, I, N, N, F))
def until_it_leaves(floats, ints, first, count, size):
    """How long ahead [s] it is to be asked which features touch, of contacts of two polyhedra of which one is at the
    end of its own; 0 where none is."""
    worst, found = LIMIT * size, -1
    for k in range(count):
        inside = extent(floats, ints, first + RECORD * k)
        if inside < worst:
            worst, found = inside, first + RECORD * k
    if found < 0:
        return 0.0
    a, b = int(floats[found + SHAPE_A]), int(floats[found + SHAPE_B])
    x, y, z = three(floats, found + POINT)
    ux, uy, uz = speed_at(floats, mover_at(ints, a), x, y, z)
    vx, vy, vz = speed_at(floats, mover_at(ints, b), x, y, z)
    ux, uy, uz = ux - vx, uy - vy, uz - vz
    speed = math.sqrt(ux * ux + uy * uy + uz * uz)
    if not speed > 1e-12 * pace(floats, found, mover_at(ints, a), mover_at(ints, b)):
        return 0.0
    reach = max(
        floats[ints[ints[SHAPES_AT] + SHAPE * a + FLOATS] + REACH],
        floats[ints[ints[SHAPES_AT] + SHAPE * b + FLOATS] + REACH],
    )
    return max(AHEAD * size, FAR * FEATURE * reach) / speed


@lean(types.void(A, I, N, A, F))
def go_ahead(floats, ints, k, motions, h):
    """Move a shape by a time h [s]: its place, and its mover."""
    at, mover = ints[PLACES_AT] + PLACE * k, mover_at(ints, k)
    for c in range(3):
        motions[c], motions[3 + c] = floats[mover + AT_V + c], floats[mover + AT_W + c]
    move(floats, at, motions, 0, h, floats, at)
    for c in range(3):
        floats[mover + AT_X + c] = floats[at + c]
        column = to_world(floats, at + 3, 1.0 * (c == 0), 1.0 * (c == 1), 1.0 * (c == 2))
        floats[mover + AT_TURN + c], floats[mover + AT_TURN + 3 + c], floats[mover + AT_TURN + 6 + c] = column
