# mypy: ignore-errors
"""Contacts of rigid bodies in `local` mode: one convex problem a step and group, in the velocities at its end.

What touches moves over the step by the velocities that Coulomb's law leaves (Moreau 1988), from where it was at the
start; what is free moves as the solver has it. Contacts are those of the start of the step, with their gaps: a pair may
come nearer by its gap and no more. Bodies that turn far in a step, or that others push aside, may come too deep by
that: where they do, contacts of the end of the step are added, and the problem is solved anew.
"""

import math

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.bodies.rigid.rigid_kernels import times_symmetric, to_body, to_world
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import SHAPE, SKINNED
from sceneql.contacts.distance.first_touch_kernels import first_touch
from sceneql.contacts.distance.first_touch_kernels import move as place_after
from sceneql.contacts.distance.manifold_kernels import MOST, NAME, POINT, manifold
from sceneql.contacts.distance.rigid_groups_kernels import MASS, solve_groups
from sceneql.contacts.distance.rigid_layout import (
    BODIES,
    BODIES_AT,
    COUNT_AT,
    CROWDED_AT,
    FORCES_AT,
    FRICTION_AT,
    KEPT_AT,
    KEPT_NAMES_AT,
    LED,
    LEDS,
    LEDS_AT,
    LOOSE_AT,
    MOST_KEPT,
    NORMALS_AT,
    PLACES_AT,
    POINTS_AT,
    RESTITUTION_AT,
    ROOM,
    ROOM_AT,
    SHAPES,
    SHAPES_AT,
    SKINS_AT,
)
from sceneql.contacts.distance.rigid_rows_kernels import (
    AT_NORMAL,
    AT_POINT,
    AT_PUSH,
    BODY_A,
    BODY_B,
    MOTION,
    PLACE,
    WHERE,
    WHO,
    add_points,
    recall,
    with_room,
)
from sceneql.contacts.distance.swept_boxes_kernels import BOX, near_pairs, swept_box
from sceneql.linear.block_order_kernels import filled
from sceneql.system.signatures_kernels import BACK_OFF, A, F, I, N

lead = lazy("sceneql.contacts.distance.led_kernels:lead", types.void(F, F, A, I, N, A, N, A, N))
skin_points = lazy(
    "sceneql.contacts.distance.skin_pair_kernels:skin_points",
    types.Tuple((I, A, N))(F, A, I, N, N, A, A, A, F, N, I, A, N),
)
cut = lazy("sceneql.contacts.distance.skin_pair_kernels:cut", F(F, A, I, N, N, A, A, F))

X_AT, V_AT, Q_AT, L_AT, MASS_AT, INERTIA_AT, WORK_AT, BODY_INTS = range(8)
"""Integers of a body: offsets of position, velocity, quaternion and angular momentum in y, of its mass and of its
inertia (xx, yy, zz, yz, xz, xy) in the floats, of the work in y."""

ROUNDS = 12
"""Most solutions of a step."""
DEEP = 1e-7
"""Part of a body's reach by which it may be inside another at the end of a step without another solution."""


@lean(types.void(A, N, A, N, A, N))
def inertia_of(y, q, floats, at, out, to):
    """Write the inertia in the world's axes (3, 3) to out[to:]."""
    for c in range(3):
        e = to_body(y, q, 1.0 * (c == 0), 1.0 * (c == 1), 1.0 * (c == 2))
        x, y_, z = to_world(y, q, *times_symmetric(floats, at, *e))
        out[to + c], out[to + 3 + c], out[to + 6 + c] = x, y_, z


@lean_inlined
def spin_by(inertia, at, x, y, z):
    """The angular velocity of an angular momentum, by the inertia (3, 3) at inertia[at:]."""
    a, b, c = inertia[at], inertia[at + 1], inertia[at + 2]
    d, e, f = inertia[at + 4], inertia[at + 5], inertia[at + 8]
    # The cofactors of a symmetric matrix.
    p, q, r = d * f - e * e, c * e - b * f, b * e - c * d
    s, t, u = a * f - c * c, b * c - a * e, a * d - b * b
    det = a * p + b * q + c * r
    return (p * x + q * y + r * z) / det, (q * x + s * y + t * z) / det, (r * x + t * y + u * z) / det


@lean(F(A, N, F))
def reach_of(motions, of, reach):
    """The largest speed of any point of a body."""
    v = math.sqrt(motions[of] ** 2 + motions[of + 1] ** 2 + motions[of + 2] ** 2)
    return v + reach * math.sqrt(motions[of + 3] ** 2 + motions[of + 4] ** 2 + motions[of + 5] ** 2)


@lean(F(A, A, N, N, F))
def speed_at(places, motions, a, b, reach):
    """The largest speed that the motion of shape b gives a point within a reach of the center of shape a."""
    far = 0.0
    for c in range(3):
        far += (places[PLACE * a + c] - places[PLACE * b + c]) ** 2
    return reach_of(motions, MOTION * b, math.sqrt(far) + reach)


@lean(types.void(F, A, A, A, I, N, A, N, A, N, A, N))
def move(h, y0, y1, floats, ints, own, masses, at, found, of, places, to):
    """Write the end of the step of a body by its velocities with contacts, and what they took to the work."""
    x, v, q, momentum = ints[own + X_AT], ints[own + V_AT], ints[own + Q_AT], ints[own + L_AT]
    mass, inertia = masses[at], at + 1
    wx, wy, wz = found[of + 3], found[of + 4], found[of + 5]
    bx, by, bz = spin_by(masses, inertia, y0[momentum], y0[momentum + 1], y0[momentum + 2])
    lost = 0.0
    for c in range(3):
        u, w, before = found[of + c], found[of + 3 + c], (bx, by, bz)[c]
        i = inertia + 3 * c
        new = masses[i] * wx + masses[i + 1] * wy + masses[i + 2] * wz
        lost += mass * ((y1[v + c] - y0[v + c]) * u - 0.5 * (u * u - y0[v + c] ** 2))
        lost += (y1[momentum + c] - y0[momentum + c]) * w - 0.5 * (new * w - y0[momentum + c] * before)
        y1[v + c] = u
        y1[x + c] = y0[x + c] + h * u
        y1[momentum + c] = new
    y1[ints[own + WORK_AT]] += lost
    for c in range(4):
        y1[q + c] = places[to + 3 + c]


@lean(types.void(F, A, I, A, A, A, F, A, A), inner=True)
def sweep(h, floats, ints, places, motions, before, more, boxes, room):
    """Write the boxes around all that the shapes sweep, wider by what they reach at the speeds of ``before``."""
    n, head = ints[BODIES], ints[SHAPES_AT]
    for k in range(ints[SHAPES]):
        reach, margin = floats[ints[head + SHAPE * k + 1] + 1], 0.0
        if k < n:
            margin = h * reach_of(before, MOTION * k, reach) + more * reach
        swept_box(
            floats, ints, head + SHAPE * k, places, PLACE * k, motions, MOTION * k, h, margin, room, boxes, BOX * k
        )


@kernel(types.int64[:, ::1](A, N), inner=True)
def pairs_of(boxes, shapes):
    """The pairs of boxes that meet (m, 2), ascending."""
    pairs = np.empty((8 * shapes + 64, 2), dtype=np.int64)
    found = near_pairs(boxes, pairs)
    if found > pairs.shape[0]:
        pairs = np.empty((found, 2), dtype=np.int64)
        near_pairs(boxes, pairs)
    return pairs[:found]


@kernel(types.int64[:, ::1](A, I, N, A, A))
def standing_pairs(floats, ints, shapes, places, room):
    """The pairs of shapes at rest whose boxes meet (m, 2), ascending; the shapes begin the integers."""
    boxes, still = np.empty(BOX * shapes), np.zeros(MOTION)
    for k in range(shapes):
        swept_box(floats, ints, SHAPE * k, places, PLACE * k, still, 0, 0.0, 0.0, room, boxes, BOX * k)
    return pairs_of(boxes, shapes)


@lean_inlined
def is_skinned(ints, a, b):
    """Whether a pair of shapes touches by skins."""
    head = ints[SHAPES_AT]
    return ints[head + SHAPE * a] == SKINNED or ints[head + SHAPE * b] == SKINNED


@lean(F(F, A, I, A, A, A, types.int64[:, ::1]), inner=True)
def shortened(h, floats, ints, places, motions, before, pairs):
    """How much of a step pairs of skins may do at once [s]."""
    n, head, least = ints[BODIES], ints[SHAPES_AT], h
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if a < n and is_skinned(ints, a, b):
            reach = floats[ints[head + SHAPE * a + 1] + 1]
            fast = reach_of(motions, MOTION * a, reach) + reach_of(before, MOTION * a, reach)
            if b < n:
                other = floats[ints[head + SHAPE * b + 1] + 1]
                fast += reach_of(motions, MOTION * b, other) + reach_of(before, MOTION * b, other)
            else:
                fast += speed_at(places, motions, a, b, reach)
            least = min(least, cut(h, floats, ints, a, b, places, motions, fast))
    return least


@kernel(types.Tuple((I, A, N))(F, A, I, A, A, A, types.int64[:, ::1], A), inner=True)
def contacts_at_start(h, floats, ints, places, motions, before, pairs, room):
    """The points where bodies touch, or would in the step by their motions without contacts."""
    n, head = ints[BODIES], ints[SHAPES_AT]
    who, where = filled(0, 0), np.empty(0)
    points, names = np.empty(MOST * POINT), filled(MOST * NAME, 0)
    contacts = 0
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if a >= n:
            break
        reach = floats[ints[head + SHAPE * a + 1] + 1]
        margin = h * (reach_of(motions, MOTION * a, reach) + reach_of(before, MOTION * a, reach)) + 1e-3 * reach
        if b < n:
            other = floats[ints[head + SHAPE * b + 1] + 1]
            margin += h * (reach_of(motions, MOTION * b, other) + reach_of(before, MOTION * b, other))
        else:
            margin += h * speed_at(places, motions, a, b, reach)
        if is_skinned(ints, a, b):
            who, where, contacts = skin_points(
                h, floats, ints, a, b, places, motions, before, margin, 0, who, where, contacts
            )
            continue
        count, gap, nx, ny, nz = manifold(
            floats, ints, head + SHAPE * a, head + SHAPE * b, places, PLACE * a, PLACE * b, margin, points, names, room
        )
        if count == 0:
            continue
        if gap > 1e-3 * reach:
            touch = first_touch(
                floats, ints, head + SHAPE * a, head + SHAPE * b, places, PLACE * a, PLACE * b,
                motions, MOTION * a, MOTION * b, h, 0.0, 1e-6 * reach, room,
            )  # fmt: skip
            if touch == math.inf:
                continue
        who, where = with_room(who, where, contacts)
        add_points(
            who, where, contacts, count, a, b, n, points, names, nx, ny, nz, places, h, floats[ints[RESTITUTION_AT]],
            motions, before, 0,
        )  # fmt: skip
        contacts += count
    return who, where, contacts


@kernel(types.Tuple((I, A, N))(F, A, I, A, A, A, A, A, I, A, N, A), inner=True)
def contacts_at_end(h, floats, ints, places, motions, before, boxes, ends, who, where, contacts, room):
    """The list with points added where bodies would be too deep in others at the end of the step."""
    n, head = ints[BODIES], ints[SHAPES_AT]
    sweep(h, floats, ints, places, motions, motions, 1e-3, boxes, room)
    pairs = pairs_of(boxes, ints[SHAPES])
    points, names = np.empty(MOST * POINT), filled(MOST * NAME, 0)
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if a >= n:
            break
        one, two, reach = head + SHAPE * a, head + SHAPE * b, floats[ints[head + SHAPE * a + 1] + 1]
        if b < n:
            reach = min(reach, floats[ints[head + SHAPE * b + 1] + 1])
        if is_skinned(ints, a, b):
            who, where, contacts = skin_points(
                h, floats, ints, a, b, ends, motions, before, -DEEP * reach, 1, who, where, contacts
            )
            continue
        count, _, nx, ny, nz = manifold(
            floats, ints, one, two, ends, PLACE * a, PLACE * b, -DEEP * reach, points, names, room
        )
        if count > 0:
            who, where = with_room(who, where, contacts)
            add_points(
                who, where, contacts, count, a, b, n, points, names, nx, ny, nz, ends, h, 0.0, motions, before, 1
            )
            contacts += count
    return who, where, contacts


@lean(types.void(A, I, I, A, N, F), inner=True)
def tell(floats, ints, who, where, contacts, h):
    """Write what is read of the contacts, and keep the impulses, as far as there is room."""
    kept = min(contacts, ints[MOST_KEPT])
    floats[ints[COUNT_AT]] = kept
    for k in range(kept):
        at = WHERE * k
        for c in range(3):
            floats[ints[POINTS_AT] + 3 * k + c] = where[at + AT_POINT + c]
            floats[ints[NORMALS_AT] + 3 * k + c] = where[at + AT_NORMAL + c]
            floats[ints[FORCES_AT] + 3 * k + c] = where[at + AT_PUSH + c] / h
            floats[ints[KEPT_AT] + 3 * k + c] = where[at + AT_PUSH + c]
        for c in range(WHO):
            ints[ints[KEPT_NAMES_AT] + WHO * k + c] = who[WHO * k + c]
    if contacts > kept:
        floats[ints[CROWDED_AT]] += 1.0


@kernel(BACK_OFF, inner=True)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Resolve the contacts of the step in y1; while STEP_END is above 0, only lower it where skins come too fast."""
    asked = floats[channels.STEP_END] > 0.0
    if asked and ints[SKINS_AT] == 0:
        return
    h = t1 - t0
    n, shapes = ints[BODIES], ints[SHAPES]
    places = floats[ints[PLACES_AT] : ints[PLACES_AT] + PLACE * shapes]
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    motions, before, masses = np.zeros(MOTION * shapes), np.zeros(MOTION * shapes), np.empty(MASS * n)
    boxes = np.empty(BOX * shapes)
    for k in range(n):
        own = ints[BODIES_AT] + BODY_INTS * k
        x, v, q, momentum = ints[own + X_AT], ints[own + V_AT], ints[own + Q_AT], ints[own + L_AT]
        for c in range(3):
            places[PLACE * k + c] = y0[x + c]
            motions[MOTION * k + c], before[MOTION * k + c] = y1[v + c], y0[v + c]
        for c in range(4):
            places[PLACE * k + 3 + c] = y0[q + c]
        masses[MASS * k] = floats[ints[own + MASS_AT]]
        inertia_of(y0, q, floats, ints[own + INERTIA_AT], masses, MASS * k + 1)
        for y, to in ((y1, motions), (y0, before)):
            wx, wy, wz = spin_by(masses, MASS * k + 1, y[momentum], y[momentum + 1], y[momentum + 2])
            to[MOTION * k + 3], to[MOTION * k + 4], to[MOTION * k + 5] = wx, wy, wz
    for k in range(ints[LEDS]):
        own = ints[LEDS_AT] + LED * k
        at = ints[own]
        lead(t0, t1, floats, ints, own + 1, places, PLACE * at, motions, MOTION * at)
        for c in range(MOTION):
            before[MOTION * at + c] = motions[MOTION * at + c]
    sweep(h, floats, ints, places, motions, before, 1e-3, boxes, room)
    pairs = pairs_of(boxes, shapes)
    if asked:
        most = shortened(h, floats, ints, places, motions, before, pairs)
        if most < 0.999 * h:
            floats[channels.STEP_END] = min(floats[channels.STEP_END], t0 + most)
        return
    who, where, contacts = contacts_at_start(h, floats, ints, places, motions, before, pairs, room)
    kept = int(floats[ints[COUNT_AT]])
    floats[ints[COUNT_AT]] = 0.0
    if pairs.shape[0] == 0:
        return
    names = ints[ints[KEPT_NAMES_AT] : ints[KEPT_NAMES_AT] + WHO * ints[MOST_KEPT]]
    recall(who, where, contacts, names, floats[ints[KEPT_AT] : ints[KEPT_AT] + 3 * ints[MOST_KEPT]], kept)
    found, ends, touched = np.empty(before.size), np.empty(places.size), filled(shapes, 0)
    for k in range(before.size):
        found[k] = before[k]
    for k in range(places.size):
        ends[k] = places[k]
    first, loose, friction = contacts, 0, floats[ints[FRICTION_AT]]
    for k in range(ints[LEDS]):
        at = ints[ints[LEDS_AT] + LED * k]
        place_after(places, PLACE * at, motions, MOTION * at, h, ends, PLACE * at)
    for number in range(ROUNDS):
        loose = solve_groups(n, who, where, contacts, masses, motions, found, friction)
        for k in range(shapes):
            touched[k] = 0
        for k in range(contacts):
            at, w = WHERE * k + AT_PUSH, WHO * k
            if where[at] != 0.0 or where[at + 1] != 0.0 or where[at + 2] != 0.0:
                touched[who[w + BODY_A]] = touched[who[w + BODY_B]] = 1
        for k in range(n):
            if touched[k] == 0:
                x, q = ints[ints[BODIES_AT] + BODY_INTS * k + X_AT], ints[ints[BODIES_AT] + BODY_INTS * k + Q_AT]
                whole = math.sqrt(y1[q] ** 2 + y1[q + 1] ** 2 + y1[q + 2] ** 2 + y1[q + 3] ** 2)
                for c in range(MOTION):
                    found[MOTION * k + c] = motions[MOTION * k + c]
                for c in range(PLACE):
                    ends[PLACE * k + c] = y1[x + c] if c < 3 else y1[q + c - 3] / whole
            else:
                place_after(places, PLACE * k, found, MOTION * k, h, ends, PLACE * k)
        if number == ROUNDS - 1:
            break
        last = contacts
        who, where, contacts = contacts_at_end(
            h, floats, ints, places, found, before, boxes, ends, who, where, contacts, room
        )
        if contacts == last:
            break
    floats[ints[LOOSE_AT]] += loose > 0
    tell(floats, ints, who, where, first, h)
    for k in range(n):
        if touched[k] != 0:
            own = ints[BODIES_AT] + BODY_INTS * k
            move(h, y0, y1, floats, ints, own, masses, MASS * k, found, MOTION * k, ends, PLACE * k)
