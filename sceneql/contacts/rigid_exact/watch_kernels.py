# mypy: ignore-errors
"""What an island's exact contacts watch for: pairs that meet, slip that ends, corners that leave their faces."""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_INVERSE, AT_R, AT_X, MOVED
from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import CORE, HALF_SPACE, SHAPE
from sceneql.contacts.distance.core_kernels import ADVANCES, FACES, FLOATS, INTS, KIND, POINTS, RADIUS, REACH
from sceneql.contacts.distance.first_touch_kernels import MOTION, first_touch, move
from sceneql.contacts.rigid_exact.contact_kernels import (
    ALONG,
    EXTENT,
    PAIR,
    RECORD,
    SHAPE_A,
    SLIDE,
    SLIP,
    TURN,
    TURN_ALONG,
    TURN_SLIP,
    dot,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import KIND as KIND_OF
from sceneql.contacts.rigid_exact.curved import FIELD, FORM
from sceneql.contacts.rigid_exact.curved_find_kernels import ask, beyond_face, is_curved, is_plain
from sceneql.contacts.rigid_exact.curved_meet_kernels import meet
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    A_COLUMN,
    A_PAIR,
    AN_ADVANCE,
    BEGUN,
    BEGUN_AT,
    DRIVES,
    KEPT,
    KEPT_AT,
    MEMORY_AT,
    MOST,
    PAIRS,
    PAIRS_AT,
    PLACE,
    PLACES_AT,
    RECORDS_AT,
    ROLLING_AT,
    ROOM,
    ROOM_AT,
    SHAPES_AT,
    WATCHED,
    WORK,
    core_at,
    driven_at,
    follow_all,
    look,
    mover_at,
    put_places,
    spots,
)
from sceneql.contacts.rigid_exact.features_kernels import extent, face_of, own, smaller
from sceneql.contacts.rigid_exact.find_kernels import TOUCHES
from sceneql.contacts.rigid_exact.rim_kernels import lying
from sceneql.contacts.rigid_exact.stop_kernels import FAR, GREATEST, LEAST, SIGNS, SLIPS, STOP, SURE, slip
from sceneql.contacts.rigid_exact.true_gap_kernels import kept_gap, true_gap
from sceneql.system.signatures_kernels import GAP as SIGNATURE
from sceneql.system.signatures_kernels import A, F, I, N

NEVER = 1e300
MOST_ADVANCES = 200
LITTLE = 1e-5
"""Way, in parts of the size of the smaller body, on which none goes through another (nor any through a half space)."""
PLAIN = 0.01
"""Distance, in the same parts, from which no gap is computed but a bound of it."""
INSIDE = 1e-7
"""How far inside its face a corner is at the start, in parts of the body's size, for its leaving to be watched."""


@lean(F(A, N, N, F, A, N))
def motion(floats, begun, now, h, motions, to):
    """Write the straight motion at constant spin from a place to another; how far its points go, by their distance."""
    for c in range(3):
        motions[to + c] = (floats[now + c] - floats[begun + c]) / h
    a, b, c, d = floats[begun + 3], floats[begun + 4], floats[begun + 5], floats[begun + 6]
    p, q, r, s = floats[now + 3], floats[now + 4], floats[now + 5], floats[now + 6]
    # The rotation from the one to the other: now times the conjugate of begun.
    w = p * a + q * b + r * c + s * d
    x, y, z = q * a - p * b - r * d + s * c, r * a - p * c - s * b + q * d, s * a - p * d - q * c + r * b
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    sine = math.sqrt(x * x + y * y + z * z)
    angle = 2.0 * math.atan2(sine, w)
    by = angle / (sine * h) if sine > 0.0 else 0.0
    motions[to + 3], motions[to + 4], motions[to + 5] = by * x, by * y, by * z
    return angle


@lean(types.boolean(A, I, N, N, N, N, A, F))
def stays_beyond(floats, ints, a, b, ma, mb, motions, h):
    """Whether a curved body is beyond the same face of what does not turn where movers are ma and mb and h [s] later,
    now, and between: how far it is, less the way of a straight line, bends by its spin's square at most."""
    sa, sb = ints[SHAPES_AT] + SHAPE * a, core_at(ints, b)
    if floats[ints[sa + FLOATS] + FORM] == FIELD or motions[9] != 0.0 or motions[10] != 0.0 or motions[11] != 0.0:
        return False
    square = motions[3] ** 2 + motions[4] ** 2 + motions[5] ** 2
    bound = 0.125 * h * h * square * floats[ints[sa + FLOATS] + REACH]
    for k in range(ints[ints[sb + INTS] + FACES]):
        if beyond_face(floats, ints, sa, sb, mover_at(ints, a), mover_at(ints, b), k) > bound:
            if beyond_face(floats, ints, sa, sb, ma, mb, k) > bound:
                return True
    return False


@lean(F(A, I, N, N, N, N, A, F, F, F, F))
def curved_touch(floats, ints, a, b, from_a, from_b, motions, speed, h, margin, last):
    """When a curved body and another first are within a margin, at the latest; as `first_touch`, by the gap over the
    largest speed; ``last``: the gap at the end."""
    ma, mb = ints[ROOM_AT], ints[ROOM_AT] + MOVED
    t = 0.0
    for _ in range(MOST_ADVANCES):
        for side in range(2):
            place, to = (from_b, mb) if side == 1 else (from_a, ma)
            moved = to + AT_INVERSE
            move(floats, place, motions, MOTION * side, t, floats, moved)
            for c in range(3):
                floats[to + AT_X + c] = floats[moved + c]
                column = to_world(floats, moved + 3, 1.0 * (c == 0), 1.0 * (c == 1), 1.0 * (c == 2))
                floats[to + AT_R + c], floats[to + AT_R + 3 + c], floats[to + AT_R + 6 + c] = column
        floats[ints[MEMORY_AT] + WORK] += A_COLUMN if is_curved(ints, ints[SHAPES_AT] + SHAPE * b) else A_PAIR
        gap = meet(floats, ints, ask(ints, -1, a, b, ma, mb), -NEVER, 0, 0)[1]
        if gap <= margin and t > 0.0:
            return t
        if t >= h or gap + last > (h - t) * speed or stays_beyond(floats, ints, a, b, ma, mb, motions, h - t):
            return h
        # (A pair may touch where it begins.)
        t += max(gap, LITTLE * smaller(floats, ints, a, b)) / speed if t == 0.0 else gap / speed
    return h


@lean(F(A, I, N, N, F, F, A, A))
def passed(floats, ints, a, b, h, gap, motions, room):
    """The gap of a pair after h: negative where the way to there went through each other."""
    begun, now = ints[BEGUN_AT], ints[PLACES_AT]
    far = 0.0
    for side in range(2):
        k = b if side == 1 else a
        shape = ints[SHAPES_AT] + SHAPE * k
        turned = motion(floats, begun + PLACE * k, now + PLACE * k, h, motions, 6 * side)
        if ints[shape + KIND] == CORE or is_curved(ints, shape):
            far += min(turned, 2.0) * floats[ints[shape + FLOATS] + REACH]
    dx, dy, dz = motions[0] - motions[6], motions[1] - motions[7], motions[2] - motions[8]
    far += h * math.sqrt(dx * dx + dy * dy + dz * dz)
    size = smaller(floats, ints, a, b)
    if far <= max(gap, LITTLE * size) or ints[core_at(ints, b) + KIND] != CORE:
        return gap
    if is_curved(ints, ints[SHAPES_AT] + SHAPE * a):
        touch = curved_touch(
            floats, ints, a, b, begun + PLACE * a, begun + PLACE * b, motions, far / h, h, 1e-10 * size, gap
        )
        return gap if touch >= h else -(h - touch) * far / h
    touch = first_touch(
        floats, ints, ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b, floats, begun + PLACE * a,
        begun + PLACE * b, motions, 0, 6, h, -1e-9 * size, 1e-10 * size, room,
    )  # fmt: skip
    floats[ints[MEMORY_AT] + WORK] += AN_ADVANCE * room[ADVANCES]
    if touch == math.inf or touch <= 0.0:
        return gap
    return -(h - touch) * far / h


@lean(F(A, I, N, N))
def beside(floats, ints, a, b):
    """How far the ball about a body's center that holds it is outside a face of another core, or its half space [m].

    The gap is no less.
    """
    sa, sb = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b
    reach = floats[ints[sa + FLOATS] + REACH] + floats[ints[sa + FLOATS] + RADIUS]
    ma, mb = mover_at(ints, a), mover_at(ints, b)
    xa, ya, za = three(floats, ma + AT_X)
    xb, yb, zb = three(floats, mb + AT_X)
    x, y, z = own(floats, mb, xa - xb, ya - yb, za - zb)
    if ints[sb + KIND] == HALF_SPACE:
        p, q, r = three(floats, ints[sb + FLOATS] + POINTS)
        return dot(p, q, r, x, y, z) - floats[ints[sb + FLOATS] + POINTS + 3] - reach
    far = -math.inf
    # (Faces that turn sweep more than their body's way.)
    turns = False
    for c in range(3, PLACE):
        turns = turns or floats[ints[BEGUN_AT] + PLACE * b + c] != floats[ints[PLACES_AT] + PLACE * b + c]
    for k in range(0 if turns else ints[ints[sb + INTS] + FACES]):
        (p, q, r), (u, v, w) = face_of(floats, ints, sb, k)
        far = max(far, dot(p, q, r, x - u, y - v, z - w))
    far = max(far, math.sqrt(x * x + y * y + z * z) - floats[ints[sb + FLOATS] + REACH])
    return far - floats[ints[sb + FLOATS] + RADIUS] - reach


@lean(F(A, I, N, N, F))
def clear(floats, ints, a, b, h):
    """A bound from below of the gap of a pair that did not meet on its way of length h [s]; else 0."""
    of, other = ints[ints[SHAPES_AT] + SHAPE * a + KIND], ints[ints[SHAPES_AT] + SHAPE * b + KIND]
    if of != CORE or (other != CORE and other != HALF_SPACE):
        return 0.0
    far = 0.0
    for side in range(2):
        m = mover_at(ints, b if side == 1 else a)
        x, y, z = three(floats, m + AT_X)
        begun = ints[BEGUN_AT] + PLACE * (b if side == 1 else a)
        p, q, r = three(floats, begun)
        far += math.sqrt((x - p) ** 2 + (y - q) ** 2 + (z - r) ** 2) if h > 0.0 else 0.0
    known = beside(floats, ints, a, b)
    # (The balls turn within themselves, and are nowhere on their way farther from here than they have come.)
    return known if known > far + PLAIN * smaller(floats, ints, a, b) else 0.0


@lean(SIGNATURE, inner=True)
def gap(t, y, gaps, floats, ints):
    """Write the gap of each pair [m] and stop, of each kept contact its slip [m/s], how far it is inside its face [m]
    and how fast it turns [rad/s], and of each motor and friction of a tie its slip."""
    memory, pairs, most, first = ints[MEMORY_AT], ints[PAIRS], ints[MOST], spots(ints)
    look(t, y, floats, ints)
    follow_all(floats, ints)
    put_places(y, floats, ints, ints[PLACES_AT])
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    motions = floats[ints[ROOM_AT] + ints[ROOM] : ints[ROOM_AT] + ints[ROOM] + 12]
    count, h = int(floats[memory + KEPT]), t - floats[memory + BEGUN]
    for pair in range(pairs):
        a, b = ints[ints[PAIRS_AT] + 2 * pair], ints[ints[PAIRS_AT] + 2 * pair + 1]
        gaps[pair] = clear(floats, ints, a, b, h)
        if gaps[pair] > 0.0:
            continue
        floats[memory + WORK] += A_COLUMN if is_curved(ints, ints[SHAPES_AT] + SHAPE * b) else A_PAIR
        now = true_gap(floats, ints, pair)
        if floats[ints[KEPT_AT] + pair] > 0.0:
            # What is kept has errors of its own; what else meets is deeper.
            now += TOUCHES * smaller(floats, ints, a, b) - kept_gap(floats, ints, pair, 0.0)
        elif h > 0.0 and now > 0.0:
            now = passed(floats, ints, a, b, h, now, motions, room)
        gaps[pair] = now
    for k in range(pairs, first + WATCHED * most + 2 * ints[DRIVES]):
        gaps[k] = NEVER
    for stop in range(2 * ints[DRIVES]):
        own, sign = driven_at(ints, stop // 2), 1.0 if stop % 2 == 0 else -1.0
        there = floats[own + (LEAST if stop % 2 == 0 else GREATEST)]
        if abs(there) < math.inf and floats[ints[KEPT_AT] + pairs + stop] == 0.0:
            gaps[pairs + stop] = sign * (floats[own + FAR] - there)
        j = stop % 2
        if floats[own + SIGNS + j] != 0.0 and floats[own + SLIPS + j] > SURE:
            gaps[first + WATCHED * most + stop] = floats[own + SIGNS + j] * slip(floats, own, j)
    for k in range(count):
        rec, at = ints[RECORDS_AT] + RECORD * k, first + WATCHED * k
        if floats[rec + TURN_SLIP] > SURE and floats[ints[ROLLING_AT]] > 0.0:
            gaps[at + 2] = dot(*three(floats, rec + TURN), *three(floats, rec + TURN_ALONG))
        if floats[rec + KIND_OF] == STOP:
            continue
        if floats[rec + SLIP] > SURE:
            gaps[at] = dot(*three(floats, rec + SLIDE), *three(floats, rec + ALONG))
        size = smaller(
            floats,
            ints,
            ints[ints[PAIRS_AT] + 2 * int(floats[rec + PAIR])],
            ints[ints[PAIRS_AT] + 2 * int(floats[rec + PAIR]) + 1],
        )
        if floats[rec + EXTENT] < math.inf:
            if floats[rec + EXTENT] > INSIDE * size:
                gaps[at + 1] = extent(floats, ints, rec)
            elif is_plain(floats, ints, int(floats[rec + SHAPE_A])):  # at a border, from where it may turn back
                gaps[at + 1] = INSIDE * size + extent(floats, ints, rec) - floats[rec + EXTENT]
        gaps[at + 1] = min(gaps[at + 1], lying(floats, ints, rec))
