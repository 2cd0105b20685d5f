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
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.first_touch_kernels import first_touch
from sceneql.contacts.distance.first_touch_kernels import move as place_after
from sceneql.contacts.distance.manifold_kernels import MOST, NAME, POINT, manifold
from sceneql.contacts.distance.rigid_groups_kernels import MASS, solve_groups
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
from sceneql.system.signatures_kernels import BACK_OFF, A, F, I, N

BODIES, SHAPES, SHAPES_AT, BODIES_AT, PLACES_AT, ROOM_AT, ROOM, KEPT_AT, KEPT_NAMES_AT, MOST_KEPT = range(10)
RESTITUTION_AT, FRICTION_AT, COUNT_AT, POINTS_AT, NORMALS_AT, FORCES_AT, LOOSE_AT, CROWDED_AT, HEAD = range(10, 19)
"""Integers of an island's contacts: numbers of bodies that move and of shapes, of which theirs come first; where the
shapes (contacts/distance/convex.py) and the bodies' integers begin; offsets into the floats of places (7 a shape), of
working memory and its size; where impulses are kept from step to step among the floats, their names among the integers,
and how many at most; offsets of the coefficients; of how many contacts there were, and of their points, normals and
forces; of the steps whose contacts were not solved to rounding, or were more than can be kept."""

X_AT, V_AT, Q_AT, L_AT, MASS_AT, INERTIA_AT, WORK_AT, BODY_INTS = range(8)
"""Integers of a body: offsets of position, velocity, quaternion and angular momentum in y, of its mass and of its
inertia (xx, yy, zz, yz, xz, xy) in the floats, of the work in y."""

ROUNDS = 6
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


@kernel(types.Tuple((I, A, N))(F, A, I, A, A, A, types.int64[:, ::1], A), inner=True)
def contacts_at_start(h, floats, ints, places, motions, before, pairs, room):
    """The points where bodies touch, or would in the step by their motions without contacts."""
    n, head = ints[BODIES], ints[SHAPES_AT]
    who, where = np.empty(0, dtype=np.int64), np.empty(0)
    points, names = np.zeros(MOST * POINT), np.zeros(MOST * NAME, dtype=np.int64)
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


@kernel(types.Tuple((I, A, N))(F, A, I, A, A, A, A, A, I, I, A, N, A), inner=True)
def contacts_at_end(h, floats, ints, places, motions, before, boxes, ends, touched, who, where, contacts, room):
    """The list with points added where bodies, moved by contacts, would be too deep in others or have crossed them."""
    n, head = ints[BODIES], ints[SHAPES_AT]
    sweep(h, floats, ints, places, motions, motions, 1e-3, boxes, room)
    pairs = pairs_of(boxes, ints[SHAPES])
    points, names = np.zeros(MOST * POINT), np.zeros(MOST * NAME, dtype=np.int64)
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if a >= n:
            break
        if touched[a] == 0 and (b >= n or touched[b] == 0):
            continue
        one, two, reach = head + SHAPE * a, head + SHAPE * b, floats[ints[head + SHAPE * a + 1] + 1]
        if b < n:
            reach = min(reach, floats[ints[head + SHAPE * b + 1] + 1])
        count, gap, nx, ny, nz = manifold(
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
    """Resolve the contacts of the step in y1."""
    if floats[channels.STEP_END] > 0.0:
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
    sweep(h, floats, ints, places, motions, before, 1e-3, boxes, room)
    who, where, contacts = contacts_at_start(h, floats, ints, places, motions, before, pairs_of(boxes, shapes), room)
    kept = int(floats[ints[COUNT_AT]])
    floats[ints[COUNT_AT]] = 0.0
    if contacts == 0:
        return
    names = ints[ints[KEPT_NAMES_AT] : ints[KEPT_NAMES_AT] + WHO * ints[MOST_KEPT]]
    recall(who, where, contacts, names, floats[ints[KEPT_AT] : ints[KEPT_AT] + 3 * ints[MOST_KEPT]], kept)
    found, ends, touched = before.copy(), places.copy(), np.zeros(shapes, dtype=np.int64)
    first, loose, friction = contacts, 0, floats[ints[FRICTION_AT]]
    for number in range(ROUNDS):
        loose = solve_groups(n, who, where, contacts, masses, motions, found, friction)
        touched[:] = 0
        for k in range(contacts):
            at, w = WHERE * k + AT_PUSH, WHO * k
            if where[at] != 0.0 or where[at + 1] != 0.0 or where[at + 2] != 0.0:
                touched[who[w + BODY_A]] = touched[who[w + BODY_B]] = 1
        for k in range(n):
            if touched[k] == 0:
                found[MOTION * k : MOTION * k + MOTION] = motions[MOTION * k : MOTION * k + MOTION]
            place_after(places, PLACE * k, found, MOTION * k, h, ends, PLACE * k)
        if number == ROUNDS - 1:
            break
        last = contacts
        who, where, contacts = contacts_at_end(
            h, floats, ints, places, found, before, boxes, ends, touched, who, where, contacts, room
        )
        if contacts == last:
            break
    floats[ints[LOOSE_AT]] += loose > 0
    tell(floats, ints, who, where, first, h)
    for k in range(n):
        if touched[k] != 0:
            own = ints[BODIES_AT] + BODY_INTS * k
            move(h, y0, y1, floats, ints, own, masses, MASS * k, found, MOTION * k, ends, PLACE * k)
