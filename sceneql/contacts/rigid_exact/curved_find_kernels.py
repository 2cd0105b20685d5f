# mypy: ignore-errors
"""Where a curved body touches a half space or a polyhedron, which may be rounded: their gap, and contacts.

On a face touches the point that is farthest out towards it, if it is over that face rather than another; on an edge or
at a corner what is nearest there, if the polyhedron goes away from it on all sides. A ring or column that lies flat has
four points of its circle as corners, of which the first is the lowest (rim_kernels).
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_R as AT_TURN
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_W, AT_X, cross, put, turned
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import CORE, SHAPE
from sceneql.contacts.distance.core_kernels import (
    EDGES,
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
from sceneql.contacts.rigid_exact.contact_kernels import (
    CORNER_FACE,
    EXTENT,
    LINE_A,
    LINE_B,
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
from sceneql.contacts.rigid_exact.crowd_kernels import LIES
from sceneql.contacts.rigid_exact.curved import CENTER, COLUMN, CURVED, ELLIPSOID, FORM, RING, SIZES
from sceneql.contacts.rigid_exact.curved_contact_kernels import FLAT, ON_CORNER, ON_EDGE, ON_FACE, ON_RIM, own
from sceneql.contacts.rigid_exact.curved_surface_kernels import away, farthest, into, slant
from sceneql.contacts.rigid_exact.exact_rows_kernels import SHAPES_AT, WHO_AT, core_at, pull_at
from sceneql.contacts.rigid_exact.rim_kernels import on_circle
from sceneql.system.signatures_kernels import A, F, I, N

rim_on_edge = lazy(
    "sceneql.contacts.rigid_exact.rim_meet_kernels:rim_on_edge",
    types.UniTuple(F, 4)(A, I, N, N, N, N, N, F, F, F, F, F, F, F, F),
)
LEVEL = 1e-13
"""Sine up to which none of its points is the lowest."""
LEAST = 1e-7
"""Part by which what is beside a place may come nearer and the place still be the nearest."""
PARALLEL = 1e-7
"""Tangent of the angle of an edge and the axis of a column up to which they are parallel."""
PIECES = 8
"""Pieces of an edge that are looked at for places that are nearest."""
HALVINGS = 60
PAIR_NAME, FIRST, SECOND, SHAPE_OF_A, SHAPE_OF_B, MOVER_A, MOVER_B, COLUMN_B, CORE_OF_A, ROCKS, WHO = range(11)
"""Integers of a question: the pair, numbers of both shapes, where these begin among the integers, and where both movers
begin among the floats; where the shape of b begins if it is a column, of which SHAPE_OF_B is the axis (else -1), and
that of a's axis; whether a circle of a may have rocked so often that it comes to lie (crowd_kernels)."""


@lean_inlined
def is_curved(ints, a):
    """Whether a shape is a curved one."""
    return ints[a + KIND] == CURVED


@lean(types.boolean(A, I, N))
def is_plain(floats, ints, m):
    """Whether a shape has no circle that may lie flat: its contacts with a polyhedron change at events alone."""
    shape = ints[SHAPES_AT] + SHAPE * m
    return ints[shape + KIND] == CORE or floats[ints[shape + FLOATS] + FORM] == ELLIPSOID


@lean(N(I, N, N, N, N, N))
def ask(ints, pair, a, b, ma, mb):
    """Write a question about a pair of shapes, whose movers begin at ma and mb; where it stands."""
    who = ints[WHO_AT]
    ints[who + ROCKS] = 0
    ints[who + PAIR_NAME], ints[who + FIRST], ints[who + SECOND] = pair, a, b
    ints[who + MOVER_A], ints[who + MOVER_B] = ma, mb
    ints[who + SHAPE_OF_A], ints[who + SHAPE_OF_B] = ints[SHAPES_AT] + SHAPE * a, core_at(ints, b)
    own = ints[SHAPES_AT] + SHAPE * b
    ints[who + COLUMN_B], ints[who + CORE_OF_A] = (own if is_curved(ints, own) else -1), core_at(ints, a)
    return who


@lean_inlined
def in_axes_of_a(floats, ma, mb, x, y, z):
    """A place of b's axes in a's."""
    px, py, pz = turned(floats, mb + AT_TURN, x, y, z)
    ax, ay, az = three(floats, ma + AT_X)
    bx, by, bz = three(floats, mb + AT_X)
    return own(floats, ma, bx + px - ax, by + py - ay, bz + pz - az)


@lean(types.void(A, I, N, N, N, F, N))
def begin_record(floats, ints, rec, who, kind, radius, shape):
    """Write a contact's shapes and kind."""
    for c in range(RECORD):
        floats[rec + c] = 0.0
    floats[rec + WHICH], floats[rec + SIGN], floats[rec + RADIUS_B] = kind, 1.0, radius
    floats[rec + SHAPE_A], floats[rec + SHAPE_B], floats[rec + PAIR] = (
        ints[who + FIRST],
        ints[who + SECOND],
        ints[who + PAIR_NAME],
    )
    floats[rec + LINE_A], floats[rec + OF], floats[rec + EXTENT] = shape, -1.0, -math.inf


@lean(types.UniTuple(F, 2)(A, N, N, N, F, F, F, F, F, F, types.boolean))
def first_point(floats, fa, ma, mb, nx, ny, nz, dx, dy, dz, asked):
    """The direction, of the shape's axes x and z, of the point of a circle that lies flat which is the lowest; if none
    is, of that which comes nearer the fastest, where it is ``asked`` which. The normal n is in the world, d against it
    in the axes of a."""
    x, _, z = into(floats, fa, dx, dy, dz)
    sine = math.sqrt(x * x + z * z)
    if sine > LEVEL:
        return x / sine, z / sine
    if asked:
        px, py, pz = three(floats, ma + AT_W)
        qx, qy, qz = three(floats, mb + AT_W)
        x, y, z = own(floats, ma, *cross(nx, ny, nz, px - qx, py - qy, pz - qz))
        x, _, z = into(floats, fa, x, y, z)
        size = math.sqrt(x * x + z * z)
        if size > LEVEL * (abs(px) + abs(py) + abs(pz) + abs(qx) + abs(qy) + abs(qz)):
            return -x / size, -z / size
    return 1.0, 0.0


@lean(types.boolean(A, I, N, N, F, F, F))
def over_face(floats, ints, shape, face, x, y, z):
    """Whether a place of a polyhedron's axes is over one of its faces rather than another."""
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    normals = f + POINTS + 3 * ints[i + VERTICES]
    first = f + POINTS + 3 * ints[loop_at(ints, i, face)[0]]
    mine = dot(*three(floats, normals + 3 * face), x - floats[first], y - floats[first + 1], z - floats[first + 2])
    for k in range(ints[i + FACES]):
        at = f + POINTS + 3 * ints[loop_at(ints, i, k)[0]]
        other = dot(*three(floats, normals + 3 * k), x - floats[at], y - floats[at + 1], z - floats[at + 2])
        if other > mine + 1e-12 * floats[f + REACH]:
            return False
    return True


@lean(types.boolean(A, I, N, F, F, F, F))
def comes_to_lie(floats, ints, who, sine, nx, ny, nz):
    """Whether a circle that is tilted against a face rocks so low, and so often, that it comes to lie there."""
    if ints[who + ROCKS] == 0 or sine > LIES:
        return False
    ax, ay, az = three(floats, ints[who + MOVER_A] + AT_W)
    bx, by, bz = three(floats, ints[who + MOVER_B] + AT_W)
    x, y, z = cross(nx, ny, nz, ax - bx, ay - by, az - bz)
    p, q, r = three(floats, pull_at(ints, ints[who + FIRST]))
    radius = floats[ints[ints[who + SHAPE_OF_A] + FLOATS] + SIZES]
    return 2.0 * radius * (x * x + y * y + z * z) <= math.sqrt(p * p + q * q + r * r) * LIES


FOUND = types.Tuple((N, F))(A, I, N, F, N, N)


@lean(FOUND)
def on_faces(floats, ints, who, margin, next, most):
    """Contacts with the faces of b: written to floats[next:] where they are within a margin, up to ``most``.

    How many there are within, and the least gap; infinity where a is over none of them.
    """
    sb, ma, mb = ints[who + SHAPE_OF_B], ints[who + MOVER_A], ints[who + MOVER_B]
    fa, fb, ib = ints[ints[who + SHAPE_OF_A] + FLOATS], ints[sb + FLOATS], ints[sb + INTS]
    solid = ints[sb + KIND] == CORE
    radius = floats[fb + RADIUS] if solid else 0.0
    count, least = 0, math.inf
    bx, by, bz = three(floats, mb + AT_X)
    ax, ay, az = three(floats, ma + AT_X)
    for k in range(ints[ib + FACES] if solid else 1):
        line = fb + POINTS + (3 * (ints[ib + VERTICES] + k) if solid else 0)
        mx, my, mz = three(floats, line)
        if solid:
            ox, oy, oz = three(floats, fb + POINTS + 3 * ints[loop_at(ints, ib, k)[0]])
        else:
            far = floats[line + 3]
            ox, oy, oz = far * mx, far * my, far * mz
        nx, ny, nz = turned(floats, mb + AT_TURN, mx, my, mz)
        dx, dy, dz = own(floats, ma, -nx, -ny, -nz)
        sine = slant(floats, fa, dx, dy, dz)
        flat = sine <= FLAT or comes_to_lie(floats, ints, who, sine, nx, ny, nz)
        within = margin + (2.1 * floats[fa + SIZES] * sine if sine > FLAT and flat else 0.0)
        ux, uz = first_point(floats, fa, ma, mb, nx, ny, nz, dx, dy, dz, most > 0) if flat else (1.0, 0.0)
        for side in range(2 if floats[fa + FORM] == COLUMN else 1):
            for spot in range(4 if flat else 1):
                sign = -1.0 if side == 1 else 1.0
                if flat:
                    # Beside the first the others, a quarter of the circle on.
                    cosine, quarter = (1.0 - spot if spot % 2 == 0 else 0.0), (2.0 - spot if spot % 2 == 1 else 0.0)
                    u, w = cosine * ux - quarter * uz, cosine * uz + quarter * ux
                    px, py, pz = on_circle(floats, fa, sign, u, w)
                    tube = floats[fa + SIZES + 1] if floats[fa + FORM] == RING else 0.0
                else:
                    px, py, pz = farthest(floats, fa, dx, dy, dz, sign, 1.0)
                    tube = 0.0
                x, y, z = turned(floats, ma + AT_TURN, px, py, pz)
                x, y, z = own(floats, mb, ax + x - bx, ay + y - by, az + z - bz)
                gap = dot(mx, my, mz, x - ox, y - oy, z - oz) - radius - tube
                if solid and not over_face(floats, ints, sb, k, x, y, z):
                    continue
                least = min(least, gap)
                if gap > within or count == most:
                    continue
                rec = next + RECORD * count
                begin_record(floats, ints, rec, who, CORNER_FACE if flat else ON_FACE, radius, fa)
                put(floats, rec + LINE_B, mx, my, mz)
                put(floats, rec + OWN_B, ox, oy, oz)
                floats[rec + SIGN], floats[rec + OF] = sign, (-1 if flat else k)
                if flat:
                    put(floats, rec + OWN_A, px, py, pz)
                    floats[rec + RADIUS_A] = tube
                count += 1
    return count, least


@lean(types.boolean(A, N, F, F, F))
def along_axis(floats, fa, ux, uy, uz):
    """Whether an edge, of a's axes, is parallel to the axis of a column: it is met in curved_meet_kernels."""
    x, y, z = into(floats, fa, ux, uy, uz)
    return floats[fa + FORM] == COLUMN and math.sqrt(x * x + z * z) <= PARALLEL * abs(y)


@lean(FOUND)
def at_corners(floats, ints, who, margin, next, most):
    """As `on_faces`, at the corners of b; where no corner is the nearest of what is around it, none."""
    sb, ma, mb = ints[who + SHAPE_OF_B], ints[who + MOVER_A], ints[who + MOVER_B]
    fa, fb, ib = ints[ints[who + SHAPE_OF_A] + FLOATS], ints[sb + FLOATS], ints[sb + INTS]
    radius = floats[fb + RADIUS]
    count, least = 0, math.inf
    for k in range(ints[ib + VERTICES]):
        ox, oy, oz = three(floats, fb + POINTS + 3 * k)
        x, y, z = in_axes_of_a(floats, ma, mb, ox, oy, oz)
        gap, nx, ny, nz = away(floats, ints, fa, x, y, z)
        gap -= radius
        if gap >= least and gap > margin:
            continue
        mx, my, mz = three(floats, fa + CENTER)
        within = abs(into(floats, fa, x - mx, y - my, z - mz)[1]) < floats[fa + SIZES + 1]
        nearest = True
        for e in range(ints[ib + EDGES]):
            edge = edges_at(ints, ib) + 4 * e
            if (ints[edge] != k and ints[edge + 1] != k) or ints[edge] == ints[edge + 1]:
                continue
            other = ints[edge + 1] if ints[edge] == k else ints[edge]
            px, py, pz = in_axes_of_a(floats, ma, mb, *three(floats, fb + POINTS + 3 * other))
            px, py, pz = px - x, py - y, pz - z
            if along_axis(floats, fa, px, py, pz) and within:
                nearest = False  # the end of an edge along which it touches
            if dot(nx, ny, nz, px, py, pz) < -LEAST * math.sqrt(px * px + py * py + pz * pz):
                nearest = False
        if not nearest:
            least = min(least, gap) if gap < 0.0 else least  # they overlap, whatever else is found
            continue
        least = min(least, gap)
        if gap > margin or count == most:
            continue
        rec = next + RECORD * count
        begin_record(floats, ints, rec, who, ON_CORNER, radius, fa)
        floats[rec + OF] = k
        put(floats, rec + OWN_B, ox, oy, oz)
        count += 1
    return count, least


@lean_inlined
def slope_along(floats, ints, fa, x, y, z, ux, uy, uz, s):
    """Distance of a curved body at a place along an edge, and how it changes along it."""
    distance, nx, ny, nz = away(floats, ints, fa, x + s * ux, y + s * uy, z + s * uz)
    return distance, dot(nx, ny, nz, ux, uy, uz)


@lean(types.boolean(A, I, N, N, N, N, F, F, F))
def goes_away(floats, ints, sb, edge, ma, mb, nx, ny, nz):
    """Whether both faces of an edge of b go away from a, whose normal there, in its axes, is n."""
    fb, ib = ints[sb + FLOATS], ints[sb + INTS]
    if ints[edge + 2] < 0 or ints[edge + 3] < 0:
        return True
    x, y, z = own(floats, mb, *turned(floats, ma + AT_TURN, nx, ny, nz))
    normals = fb + POINTS + 3 * ints[ib + VERTICES]
    one, other = normals + 3 * ints[edge + 2], normals + 3 * ints[edge + 3]
    p, q = dot(*three(floats, one), x, y, z), dot(*three(floats, other), x, y, z)
    both = dot(*three(floats, one), *three(floats, other))
    return both * p - q >= -LEAST and both * q - p >= -LEAST


@lean(F(A, I, N, F, F, F, F, F, F, F, F))
def nearest_between(floats, ints, fa, x, y, z, ux, uy, uz, low, high):
    """Where along an edge the distance no longer falls, by bisection."""
    for _ in range(HALVINGS):
        s = 0.5 * (low + high)
        if slope_along(floats, ints, fa, x, y, z, ux, uy, uz, s)[1] < 0.0:
            low = s
        else:
            high = s
    return 0.5 * (low + high)


@lean(FOUND)
def on_edges(floats, ints, who, margin, next, most):
    """As `on_faces`, between the ends of the edges of b."""
    sb, ma, mb = ints[who + SHAPE_OF_B], ints[who + MOVER_A], ints[who + MOVER_B]
    fa, fb, ib = ints[ints[who + SHAPE_OF_A] + FLOATS], ints[sb + FLOATS], ints[sb + INTS]
    radius = floats[fb + RADIUS]
    count, least = 0, math.inf
    for e in range(ints[ib + EDGES]):
        edge = edges_at(ints, ib) + 4 * e
        ox, oy, oz = three(floats, fb + POINTS + 3 * ints[edge])
        lx, ly, lz = three(floats, fb + POINTS + 3 * ints[edge + 1])
        x, y, z = in_axes_of_a(floats, ma, mb, ox, oy, oz)
        ux, uy, uz = in_axes_of_a(floats, ma, mb, lx, ly, lz)
        ux, uy, uz = ux - x, uy - y, uz - z
        length = math.sqrt(ux * ux + uy * uy + uz * uz)
        middle = away(floats, ints, fa, x + 0.5 * ux, y + 0.5 * uy, z + 0.5 * uz)[0]
        if along_axis(floats, fa, ux, uy, uz):
            continue
        if length == 0.0 or middle - 0.5 * length - radius > max(margin, least):
            continue
        tx, ty, tz = (lx - ox) / length, (ly - oy) / length, (lz - oz) / length
        low, before = 0.0, slope_along(floats, ints, fa, x, y, z, ux, uy, uz, 0.0)[1]
        for piece in range(1, PIECES + 1):
            high = piece / PIECES
            after = slope_along(floats, ints, fa, x, y, z, ux, uy, uz, high)[1]
            if before < 0.0 and after >= 0.0:
                s = nearest_between(floats, ints, fa, x, y, z, ux, uy, uz, low, high)
                gap, nx, ny, nz = away(floats, ints, fa, x + s * ux, y + s * uy, z + s * uz)
                gap -= radius
                side, angle, far = 0.0, 0.0, s * length
                if floats[fa + FORM] == COLUMN and radius == 0.0 and gap <= floats[fa + SIZES]:
                    side, angle, on, deep = rim_on_edge(
                        floats, ints, fa, sb, edge, ma, mb, gap, far, ox, oy, oz, tx, ty, tz
                    )
                    gap, far = (deep, on) if side != 0.0 else (gap, far)
                known = side != 0.0 or goes_away(floats, ints, sb, edge, ma, mb, nx, ny, nz)
                if (gap < least or gap <= margin) and not known and gap < 0.0:
                    least = min(least, gap)  # they overlap, whatever else is found
                elif (gap < least or gap <= margin) and known:
                    least = min(least, gap)
                    if gap <= margin and count < most:
                        rec = next + RECORD * count
                        begin_record(floats, ints, rec, who, (ON_RIM if side != 0.0 else ON_EDGE), radius, fa)
                        put(floats, rec + OWN_B, ox, oy, oz)
                        put(floats, rec + LINE_B, tx, ty, tz)
                        floats[rec + LINE_A + 1], floats[rec + LINE_A + 2], floats[rec + OF] = far, angle, e
                        floats[rec + SIGN] = side if side != 0.0 else 1.0
                        count += 1
            low, before = high, after
    return count, least


@lean(F(A, I, N, N, N, N, N))
def beyond_face(floats, ints, sa, sb, ma, mb, k):
    """How far a curved body is on the outer side of face k of b; movers begin at ma and mb."""
    fa, fb, ib = ints[sa + FLOATS], ints[sb + FLOATS], ints[sb + INTS]
    ax, ay, az = three(floats, ma + AT_X)
    bx, by, bz = three(floats, mb + AT_X)
    mx, my, mz = three(floats, fb + POINTS + 3 * (ints[ib + VERTICES] + k))
    ox, oy, oz = three(floats, fb + POINTS + 3 * ints[loop_at(ints, ib, k)[0]])
    nx, ny, nz = turned(floats, mb + AT_TURN, mx, my, mz)
    dx, dy, dz = own(floats, ma, -nx, -ny, -nz)
    nearest = math.inf
    for side in range(2):
        px, py, pz = farthest(floats, fa, dx, dy, dz, -1.0 if side == 1 else 1.0, 1.0)
        x, y, z = turned(floats, ma + AT_TURN, px, py, pz)
        x, y, z = own(floats, mb, ax + x - bx, ay + y - by, az + z - bz)
        nearest = min(nearest, dot(mx, my, mz, x - ox, y - oy, z - oz))
    return nearest - floats[fb + RADIUS]


@lean(F(A, I, N))
def separation(floats, ints, who):
    """How far a curved body is on the outer side of a face of b, at most: below 0 where they overlap deeply."""
    sa, sb, most = ints[who + SHAPE_OF_A], ints[who + SHAPE_OF_B], -math.inf
    for k in range(ints[ints[sb + INTS] + FACES]):
        most = max(most, beyond_face(floats, ints, sa, sb, ints[who + MOVER_A], ints[who + MOVER_B], k))
    return most
