# mypy: ignore-errors
"""What an island's exact contacts watch for: pairs that meet, slip that ends, corners that leave their faces."""

import math

from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import CORE, SHAPE
from sceneql.contacts.distance.core_kernels import FLOATS, KIND, REACH
from sceneql.contacts.distance.first_touch_kernels import first_touch
from sceneql.contacts.distance.gap_kernels import gap as distance
from sceneql.contacts.rigid_exact.contact_kernels import ALONG, EXTENT, GAP, PAIR, RECORD, SLIDE, SLIP, dot, three
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    AGAIN,
    BEGUN,
    BEGUN_AT,
    ENDURANCE,
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
    follow_all,
    look,
    put_places,
)
from sceneql.contacts.rigid_exact.find_kernels import TOUCHES, extent, smaller
from sceneql.system.signatures_kernels import GAP as SIGNATURE
from sceneql.system.signatures_kernels import A, F, I, N

NEVER = 1e300
LITTLE = 1e-5
"""Way, in parts of the size of the smaller body, on which none goes through another (nor any through a half space)."""
INSIDE = 1e-7
"""How far inside its face a corner is at the start, in parts of the body's size, for its leaving to be watched."""
SURE = 1e-9
"""Slip at the start of a step [m/s] for its end to be watched."""


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


@lean(F(A, I, N, N, F, F, A, A))
def passed(floats, ints, a, b, h, gap, motions, room):
    """The gap of a pair after h: negative where the way to there went through each other."""
    begun, now = ints[BEGUN_AT], ints[PLACES_AT]
    far = 0.0
    for side in range(2):
        k = b if side == 1 else a
        shape = ints[SHAPES_AT] + SHAPE * k
        turned = motion(floats, begun + PLACE * k, now + PLACE * k, h, motions, 6 * side)
        if ints[shape + KIND] == CORE:
            far += min(turned, 2.0) * floats[ints[shape + FLOATS] + REACH]
    dx, dy, dz = motions[0] - motions[6], motions[1] - motions[7], motions[2] - motions[8]
    far += h * math.sqrt(dx * dx + dy * dy + dz * dz)
    size = smaller(floats, ints, a, b)
    if far <= max(gap, LITTLE * size) or ints[ints[SHAPES_AT] + SHAPE * b + KIND] != CORE:
        return gap
    touch = first_touch(
        floats, ints, ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b, floats, begun + PLACE * a,
        begun + PLACE * b, motions, 0, 6, h, -1e-9 * size, 1e-10 * size, room,
    )  # fmt: skip
    if touch == math.inf or touch <= 0.0:
        return gap
    return -(h - touch) * far / h


@lean(SIGNATURE, inner=True)
def gap(t, y, gaps, floats, ints):
    """Write the gap of each pair [m], and of each kept contact its slip [m/s] and how far it is inside its face [m]."""
    memory, pairs, most = ints[MEMORY_AT], ints[PAIRS], ints[MOST]
    look(t, y, floats, ints)
    follow_all(floats, ints)
    put_places(y, floats, ints, ints[PLACES_AT])
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    motions = floats[ints[ROOM_AT] + ints[ROOM] : ints[ROOM_AT] + ints[ROOM] + 12]
    count, h = int(floats[memory + KEPT]), t - floats[memory + BEGUN]
    for pair in range(pairs):
        a, b = ints[ints[PAIRS_AT] + 2 * pair], ints[ints[PAIRS_AT] + 2 * pair + 1]
        now = distance(
            floats, ints, ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b, floats,
            ints[PLACES_AT] + PLACE * a, ints[PLACES_AT] + PLACE * b, room,
        )[0]  # fmt: skip
        if floats[ints[KEPT_AT] + pair] > 0.0:
            # What is kept has errors of its own; what else meets is deeper.
            least = 0.0
            for k in range(count):
                rec = ints[RECORDS_AT] + RECORD * k
                if floats[rec + PAIR] == pair:
                    least = min(least, floats[rec + GAP])
            now += TOUCHES * smaller(floats, ints, a, b) - least
        elif h > 0.0 and now > 0.0:
            now = passed(floats, ints, a, b, h, now, motions, room)
        if floats[memory + AGAIN] >= ENDURANCE and abs(now) <= 10.0 * TOUCHES * smaller(floats, ints, a, b):
            now = NEVER
        gaps[pair] = now
    for k in range(most):
        gaps[pairs + 2 * k] = gaps[pairs + 2 * k + 1] = NEVER
    for k in range(count):
        rec, at = ints[RECORDS_AT] + RECORD * k, pairs + 2 * k
        if floats[rec + SLIP] > SURE:
            gaps[at] = dot(*three(floats, rec + SLIDE), *three(floats, rec + ALONG))
        size = smaller(
            floats,
            ints,
            ints[ints[PAIRS_AT] + 2 * int(floats[rec + PAIR])],
            ints[ints[PAIRS_AT] + 2 * int(floats[rec + PAIR]) + 1],
        )
        if floats[rec + EXTENT] > INSIDE * size and floats[rec + EXTENT] < math.inf:
            gaps[at + 1] = extent(floats, ints, rec)
