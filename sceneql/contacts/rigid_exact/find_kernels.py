# mypy: ignore-errors
"""The contacts of a state: which features of two shapes touch, found once and then followed (contact_kernels)."""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_X, put
from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import CORE, SHAPE
from sceneql.contacts.distance.core_kernels import (
    KIND,
)
from sceneql.contacts.distance.manifold_kernels import POINT as CORNER
from sceneql.contacts.distance.manifold_kernels import manifold
from sceneql.contacts.rigid_exact.contact_kernels import (
    ALONG,
    EXTENT,
    FAST,
    FORCE,
    GAP,
    OF,
    PAIR,
    POINT,
    PUSHES,
    RECORD,
    SIGN,
    SLIDE,
    SLIDES,
    SLIP,
    SLOW,
    TORQUE,
    three,
)
from sceneql.contacts.rigid_exact.contact_kernels import KIND as KIND_OF
from sceneql.contacts.rigid_exact.crowd_kernels import rocks_often
from sceneql.contacts.rigid_exact.curved_ahead_kernels import meet_ahead
from sceneql.contacts.rigid_exact.curved_contact_kernels import follow
from sceneql.contacts.rigid_exact.curved_find_kernels import ROCKS, ask, is_curved, is_plain
from sceneql.contacts.rigid_exact.exact_hold_kernels import CREEP, STILL, still
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    BEGUN,
    BEGUN_AT,
    CROWDED,
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
    ROOM,
    ROOM_AT,
    SHAPES_AT,
    SINCE,
    UNDECIDED,
    driven_at,
    follow_all,
    look,
    mover_at,
    put_places,
    spots,
)
from sceneql.contacts.rigid_exact.extra_rows_kernels import begin_turning
from sceneql.contacts.rigid_exact.features_kernels import (
    AHEAD,
    LIMIT,
    extent,
    go_ahead,
    meet_ball,
    size_at,
    smaller,
    solid_side,
    until_it_leaves,
)
from sceneql.contacts.rigid_exact.naming_kernels import name
from sceneql.contacts.rigid_exact.rim_kernels import begin_tilt, lies
from sceneql.contacts.rigid_exact.stop_kernels import (
    FAR,
    FIRST_MOVER,
    GREATEST,
    LEAST,
    SECOND_MOVER,
    SIZE,
    STOP,
    begin_slips,
    write_stop,
)
from sceneql.system.signatures_kernels import A, F, I, N

TOUCHES = 1e-10
"""Gap, in parts of the size of the smaller body, up to which shapes touch."""
DEEP = 1e-3
"""Overlap, in the same parts, up to which a point is a contact: a step's error leaves far less."""
SLACK = 1e-4
"""Gap, in the same parts, up to which a contact that pushed still is one: what a step's error leaves is closed."""


@lean(N(A, I, N, N, N, N, F))
def carried(floats, ints, a, b, pair, before, margin):
    """The contact of a ball or an ellipsoid on a polyhedron, of which each change is an event; -1 for others."""
    sa, sb = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b
    curved = is_curved(ints, sa) and is_plain(floats, ints, a) and ints[sb + KIND] == CORE
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


@lean(N(A, I, N, N, N, F, N, N, A, I))
def touching(floats, ints, pair, a, b, margin, next, most, points, names):
    """Write the contacts of a pair of polyhedra, balls and planes, where these are now; how many there are, of which
    the first ``most`` are written."""
    sa, sb, at = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b, ints[PLACES_AT]
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    found, _, nx, ny, nz = manifold(
        floats, ints, sa, sb, floats, at + PLACE * a, at + PLACE * b, margin, points, names, room
    )
    count, side = 0, solid_side(ints, a, b)
    for k in range(found if side < 0 else min(found, 1)):
        p, rec = CORNER * k, next + RECORD * count
        if points[p + 6] > margin or points[p + 6] < -DEEP * smaller(floats, ints, a, b) - margin:
            continue
        count += 1
        if count > most:
            continue
        if side >= 0:
            meet_ball(floats, ints, rec, pair, a, b, side)
        else:
            name(floats, ints, rec, pair, a, b, *three(points, p), *three(points, p + 3), nx, ny, nz)
            follow(floats, ints, rec, mover_at(ints, a), mover_at(ints, b))
    return count


@lean(N(F, A, F, A, I, N, N, N, F, N, N, N, A, I))
def leave(t, y, h, floats, ints, pair, a, b, margin, next, count, most, points, names):
    """Of contacts of two polyhedra of which one leaves its face or edge within h [s], those that stay or come; how
    many."""
    size, leaves = smaller(floats, ints, a, b), False
    motions = floats[ints[ROOM_AT] + ints[ROOM] : ints[ROOM_AT] + ints[ROOM] + 12]
    ends = 0
    for k in range(count):
        if extent(floats, ints, next + RECORD * k) < LIMIT * size:
            ends |= 1 << k
    go_ahead(floats, ints, a, motions, h)
    go_ahead(floats, ints, b, motions, h)
    for k in range(count):
        rec = next + RECORD * k
        follow(floats, ints, rec, mover_at(ints, a), mover_at(ints, b))
        leaves = leaves or (ends & (1 << k) != 0 and extent(floats, ints, rec) < -LIMIT * size)
    found = count
    if leaves:
        margin_there = margin + LIMIT * AHEAD * size
        found = min(most, touching(floats, ints, pair, a, b, margin_there, next, most, points, names))
    look(t, y, floats, ints)
    put_places(y, floats, ints, ints[PLACES_AT])
    kept = 0
    for k in range(found):
        rec, to = next + RECORD * k, next + RECORD * kept
        follow(floats, ints, rec, mover_at(ints, a), mover_at(ints, b))
        if floats[rec + GAP] > margin:
            continue
        for c in range(RECORD if to != rec else 0):
            floats[to + c] = floats[rec + c]
        kept += 1
    return kept


@lean(N(A, I, N, N, N))
def at_stop(floats, ints, stop, rec, room):
    """Write the contact with a stop, of which the lower one of each tie is even, if it touches; whether it does."""
    own, sign = driven_at(ints, stop // 2), 1.0 if stop % 2 == 0 else -1.0
    there, size = floats[own + (LEAST if stop % 2 == 0 else GREATEST)], floats[own + SIZE]
    if abs(there) == math.inf or room == 0:
        return 0
    gap, spot, open = sign * (floats[own + FAR] - there), ints[PAIRS] + stop, 0.0
    for j in range(int(floats[ints[MEMORY_AT] + KEPT])):
        old = ints[RECORDS_AT] + RECORD * j
        if floats[old + PAIR] == spot and floats[old + PUSHES] > 0.0:
            open = min(floats[old + GAP], SLACK * size)
    margin = TOUCHES * size + max(0.0, open) + 1e-14 * (abs(there) + abs(floats[own + FAR]))
    if not -DEEP * size - margin <= gap <= margin:
        return 0
    first, second = int(floats[own + FIRST_MOVER]), int(floats[own + SECOND_MOVER])
    write_stop(floats, rec, own, first, second, sign, spot, mover_at(ints, first))
    return 1


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
        sa, sb = ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b
        old = carried(floats, ints, a, b, pair, before, margin) if goes_on else -1
        if old >= 0 and count < most:
            for c in range(RECORD):
                floats[next + RECORD * count + c] = floats[old + c]
            count, same = count + 1, same + 1
            continue
        if is_curved(ints, sa) and goes_on and lies(floats, ints, pair, before):
            for j in range(before):
                old = ints[RECORDS_AT] + RECORD * j
                if floats[old + PAIR] == pair and count < most:
                    for c in range(RECORD):
                        floats[next + RECORD * count + c] = floats[old + c]
                    count, same = count + 1, same + 1
            continue
        if is_curved(ints, sa):
            who = ask(ints, pair, a, b, mover_at(ints, a), mover_at(ints, b))
            # What rocks, or runs round its circle, again and again and lower than is seen comes to lie.
            ints[who + ROCKS] = not goes_on and rocks_often(floats, ints, pair)
            count += meet_ahead(floats, ints, who, margin, next + RECORD * count, most - count)
            continue
        more = touching(floats, ints, pair, a, b, margin, next + RECORD * count, most - count, points, names)
        floats[memory + CROWDED] += max(0, more - most + count)
        more = min(more, most - count)
        if not goes_on and solid_side(ints, a, b) < 0 and ints[sb + KIND] == CORE:
            size = smaller(floats, ints, a, b)
            h = until_it_leaves(floats, ints, next + RECORD * count, more, size)
            if h > 0.0:
                more = leave(
                    t, y, h, floats, ints, pair, a, b, margin, next + RECORD * count, more, most - count, points, names
                )
        count += more
    for stop in range(2 * ints[DRIVES]):
        found = at_stop(floats, ints, stop, next + RECORD * count, most - count)
        same += found if goes_on and floats[ints[KEPT_AT] + ints[PAIRS] + stop] > 0.0 else 0
        count += found
    for k in range(count):
        rec = next + RECORD * k
        for j in range(before):
            old = ints[RECORDS_AT] + RECORD * j
            if floats[old + PAIR] != floats[rec + PAIR]:
                continue
            away = 0.0
            for c in range(3):
                away = max(away, abs(floats[old + POINT + c] - floats[rec + POINT + c]))
            reach = size_at(floats, ints, rec)
            # What is round may roll far in a step.
            rolled = floats[rec + OF] >= 0.0 and floats[old + OF] >= 0.0
            if (
                away <= 1e-3 * reach
                or floats[rec + KIND_OF] == STOP
                or (rolled and floats[old + SIGN] == floats[rec + SIGN])
            ):
                for c in range(3):
                    floats[rec + FORCE + c] = floats[old + FORCE + c]
                    floats[rec + ALONG + c] = floats[old + ALONG + c]
                    floats[rec + TORQUE + c] = floats[old + TORQUE + c]
                floats[rec + PUSHES] = floats[old + PUSHES]
    for c in range(RECORD * count):
        floats[ints[RECORDS_AT] + c] = floats[next + c]
    floats[memory + KEPT] = count
    return same == before and count == before


@lean(types.void(F, A, A, I, types.boolean))
def begin(t, y, floats, ints, same):
    """Mark the contacts that are kept from a time on, open as to which slide or leave; ``same``: as before."""
    memory = ints[MEMORY_AT]
    for pair in range(spots(ints)):
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
        same = begin_turning(floats, ints, rec, STILL, CREEP) and same
        begin_tilt(floats, ints, rec)
        inside = extent(floats, ints, rec)
        # (From where it began, so that what creeps over a border is told.)
        floats[rec + EXTENT] = max(inside, floats[rec + EXTENT]) if floats[rec + OF] >= 0.0 else inside
    for d in range(ints[DRIVES]):
        same = begin_slips(floats, driven_at(ints, d)) and same
    floats[memory + UNDECIDED] = 1.0
    if not same:
        floats[memory + SINCE] = t


@lean(types.void(F, A, A, I))
def start_step(t, y, floats, ints):
    """Keep where the shapes are at the start of a step."""
    look(t, y, floats, ints)
    put_places(y, floats, ints, ints[BEGUN_AT])
    floats[ints[MEMORY_AT] + BEGUN] = t
