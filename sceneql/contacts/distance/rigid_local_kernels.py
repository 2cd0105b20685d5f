# mypy: ignore-errors
"""Contacts of rigid bodies in `local` mode: one convex problem a step, in the velocities at its end.

What touches moves over the step by the velocities that Coulomb's law leaves (Moreau 1988), from where it was at the
start; what is free moves as the solver has it. Contacts are those of the start of the step, with their gaps: a pair may
come nearer by its gap and no more, so that nothing passes through anything at any step.
"""

import math

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.bodies.rigid.rigid_kernels import times_symmetric, to_body, to_world
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.first_touch_kernels import first_touch
from sceneql.contacts.distance.manifold_kernels import MOST, NAME, POINT, manifold
from sceneql.contacts.distance.swept_boxes_kernels import BOX, near_pairs, swept_box
from sceneql.linear.cone_kernels import SOLVED, solve
from sceneql.linear.cone_rows_kernels import (
    AT_ARM_A,
    AT_ARM_B,
    AT_FREE,
    AT_FRICTION,
    AT_GIVEN,
    AT_IMPULSE,
    AT_INERTIA,
    AT_MASS,
    AT_NORMAL,
    AT_V,
    BODY,
    CONTACT,
    CONTACT_INTS_AT,
    CONTACTS,
    CONTACTS_AT,
)
from sceneql.system.signatures_kernels import BACK_OFF, A, F, I, N

BODIES, SHAPES, SHAPES_AT, BODIES_AT, PLACES_AT, MOTIONS_AT, BOXES_AT, ROOM_AT, ROOM = range(9)
PROGRAM_AT, PROGRAM, PROGRAM_INTS_AT, PROGRAM_INTS, MOST_CONTACTS, RESTITUTION_AT, FRICTION_AT = range(9, 16)
COUNT_AT, POINTS_AT, NORMALS_AT, FORCES_AT, LOOSE_AT, CROWDED_AT, HEAD = range(16, 23)
"""Integers of an island's contacts: numbers of bodies that move and of shapes, of which theirs come first; where the
shapes (contacts/distance/convex.py) and the bodies' integers begin; offsets into the floats of places (7 a shape),
motions (6), boxes, working memory and its size; of the cone program's floats and their number, and where its integers
begin and their number; room for contacts; offsets of the coefficients; of how many contacts there were, and of their
points, normals and forces; of the steps whose contacts were not solved to rounding, or had no room."""

PLACE, MOTION = 7, 6
X_AT, V_AT, Q_AT, L_AT, MASS_AT, INERTIA_AT, WORK_AT, BODY_INTS = range(8)
"""Integers of a body: offsets of position, velocity, quaternion and angular momentum in y, of its mass and of its
inertia (xx, yy, zz, yz, xz, xy) in the floats, of the work in y."""

BOUNCES = 2.0
"""A contact bounces that approaches faster than the step's forces make it in so many steps."""


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


@lean_inlined
def at_point(motions, of, rx, ry, rz):
    """Velocity of a point of a moving body."""
    wx, wy, wz = motions[of + 3], motions[of + 4], motions[of + 5]
    return (
        motions[of] + wy * rz - wz * ry,
        motions[of + 1] + wz * rx - wx * rz,
        motions[of + 2] + wx * ry - wy * rx,
    )


@lean(F(A, N, F))
def reach_of(motions, of, reach):
    """The largest speed of any point of a body."""
    v = math.sqrt(motions[of] ** 2 + motions[of + 1] ** 2 + motions[of + 2] ** 2)
    return v + reach * math.sqrt(motions[of + 3] ** 2 + motions[of + 4] ** 2 + motions[of + 5] ** 2)


@lean(types.void(F, A, A, A, I, N, A, N, A, N))
def move(h, y0, y1, floats, ints, own, program, body, before, at):
    """Write the end of the step of a body by its velocities with contacts, and what they took to the work."""
    x, v, q, momentum = ints[own + X_AT], ints[own + V_AT], ints[own + Q_AT], ints[own + L_AT]
    mass, inertia = program[body + AT_MASS], body + AT_INERTIA
    wx, wy, wz = program[body + AT_V + 3], program[body + AT_V + 4], program[body + AT_V + 5]
    new = (
        program[inertia] * wx + program[inertia + 1] * wy + program[inertia + 2] * wz,
        program[inertia + 3] * wx + program[inertia + 4] * wy + program[inertia + 5] * wz,
        program[inertia + 6] * wx + program[inertia + 7] * wy + program[inertia + 8] * wz,
    )
    lost = 0.0
    for c in range(3):
        u, w = program[body + AT_V + c], program[body + AT_V + 3 + c]
        lost += mass * ((y1[v + c] - y0[v + c]) * u - 0.5 * (u * u - y0[v + c] ** 2))
        lost += (y1[momentum + c] - y0[momentum + c]) * w - 0.5 * (new[c] * w - y0[momentum + c] * before[at + 3 + c])
        y1[v + c] = u
        y1[x + c] = y0[x + c] + h * u
        y1[momentum + c] = new[c]
    y1[ints[own + WORK_AT]] += lost
    angle = h * math.sqrt(wx * wx + wy * wy + wz * wz)
    s = 0.5 * h * (math.sin(0.5 * angle) / (0.5 * angle) if angle > 1e-8 else 1.0)
    a, b, c, d = y0[q], y0[q + 1], y0[q + 2], y0[q + 3]
    e, f, g, k = math.cos(0.5 * angle), s * wx, s * wy, s * wz
    y1[q] = e * a - f * b - g * c - k * d
    y1[q + 1] = e * b + f * a + g * d - k * c
    y1[q + 2] = e * c + g * a + k * b - f * d
    y1[q + 3] = e * d + k * a + f * c - g * b


@kernel(BACK_OFF, inner=True)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Resolve the contacts of the step in y1."""
    if floats[channels.STEP_END] > 0.0:
        return
    h = t1 - t0
    n, shapes, head = ints[BODIES], ints[SHAPES], ints[SHAPES_AT]
    places = floats[ints[PLACES_AT] : ints[PLACES_AT] + PLACE * shapes]
    motions = floats[ints[MOTIONS_AT] : ints[MOTIONS_AT] + MOTION * shapes]
    boxes = floats[ints[BOXES_AT] : ints[BOXES_AT] + BOX * shapes]
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    program = floats[ints[PROGRAM_AT] : ints[PROGRAM_AT] + ints[PROGRAM]]
    plan = ints[ints[PROGRAM_INTS_AT] : ints[PROGRAM_INTS_AT] + ints[PROGRAM_INTS]]
    before = np.zeros(MOTION * shapes)
    floats[ints[COUNT_AT]] = 0.0
    for k in range(n):
        own, body = ints[BODIES_AT] + BODY_INTS * k, BODY * k
        x, v, q, momentum = ints[own + X_AT], ints[own + V_AT], ints[own + Q_AT], ints[own + L_AT]
        for c in range(3):
            places[PLACE * k + c] = y0[x + c]
            motions[MOTION * k + c], before[MOTION * k + c] = y1[v + c], y0[v + c]
        for c in range(4):
            places[PLACE * k + 3 + c] = y0[q + c]
        program[body + AT_MASS] = floats[ints[own + MASS_AT]]
        inertia_of(y0, q, floats, ints[own + INERTIA_AT], program, body + AT_INERTIA)
        for y, to in ((y1, motions), (y0, before)):
            wx, wy, wz = spin_by(program, body + AT_INERTIA, y[momentum], y[momentum + 1], y[momentum + 2])
            to[MOTION * k + 3], to[MOTION * k + 4], to[MOTION * k + 5] = wx, wy, wz
        for c in range(6):
            program[body + AT_FREE + c] = program[body + AT_V + c] = motions[MOTION * k + c]
    for k in range(shapes):
        reach = floats[ints[head + SHAPE * k + 1] + 1]
        margin = 0.0
        if k < n:
            margin = h * reach_of(before, MOTION * k, reach) + 1e-3 * reach
        swept_box(
            floats, ints, head + SHAPE * k, places, PLACE * k, motions, MOTION * k, h, margin, room, boxes, BOX * k
        )
    most = 8 * shapes + 64
    pairs = np.empty((most, 2), dtype=np.int64)
    found = near_pairs(boxes, pairs)
    if found > most:
        pairs = np.empty((found, 2), dtype=np.int64)
        found = near_pairs(boxes, pairs)
    points, names = np.zeros(MOST * POINT), np.zeros(MOST * NAME, dtype=np.int64)
    friction, restitution = floats[ints[FRICTION_AT]], floats[ints[RESTITUTION_AT]]
    contacts, crowded = 0, 0.0
    for p in range(found):
        a, b = pairs[p, 0], pairs[p, 1]
        if a >= n:
            continue
        reach = floats[ints[head + SHAPE * a + 1] + 1]
        margin = h * (reach_of(motions, MOTION * a, reach) + reach_of(before, MOTION * a, reach)) + 1e-3 * reach
        if b < n:
            other = floats[ints[head + SHAPE * b + 1] + 1]
            margin += h * (reach_of(motions, MOTION * b, other) + reach_of(before, MOTION * b, other))
        count, gap, nx, ny, nz = manifold(
            floats, ints, head + SHAPE * a, head + SHAPE * b, places, PLACE * a, PLACE * b, margin, points, names, room
        )
        far = gap > 1e-3 * reach
        if count == 0:
            continue
        if far:
            touch = first_touch(
                floats, ints, head + SHAPE * a, head + SHAPE * b, places, PLACE * a, PLACE * b,
                motions, MOTION * a, MOTION * b, h, 0.0, 1e-6 * reach, room,
            )  # fmt: skip
            if touch == math.inf:
                continue
        if contacts + count > ints[MOST_CONTACTS]:
            crowded = 1.0
            continue
        pair = a * n - a * (a + 1) // 2 + b - a - 1 if b < n else n * (n - 1) // 2 + a
        for k in range(count):
            at, c = POINT * k, plan[CONTACTS_AT] + CONTACT * contacts
            plan[plan[CONTACT_INTS_AT] + contacts] = pair
            rx, ry, rz = (
                points[at] - places[PLACE * a],
                points[at + 1] - places[PLACE * a + 1],
                points[at + 2] - places[PLACE * a + 2],
            )
            sx, sy, sz = (
                points[at + 3] - places[PLACE * b],
                points[at + 4] - places[PLACE * b + 1],
                points[at + 5] - places[PLACE * b + 2],
            )
            program[c + AT_NORMAL], program[c + AT_NORMAL + 1], program[c + AT_NORMAL + 2] = nx, ny, nz
            program[c + AT_ARM_A], program[c + AT_ARM_A + 1], program[c + AT_ARM_A + 2] = rx, ry, rz
            program[c + AT_ARM_B], program[c + AT_ARM_B + 1], program[c + AT_ARM_B + 2] = sx, sy, sz
            program[c + AT_FRICTION] = friction
            own = points[at + 6]
            was, will = 0.0, 0.0
            for early in range(2):
                m = before if early == 1 else motions
                ux, uy, uz = at_point(m, MOTION * a, rx, ry, rz)
                if b < n:
                    wx, wy, wz = at_point(m, MOTION * b, sx, sy, sz)
                    ux, uy, uz = ux - wx, uy - wy, uz - wz
                speed = nx * ux + ny * uy + nz * uz
                if early == 1:
                    was = speed
                else:
                    will = speed
            given = own / h
            if own + h * will < 0.0 and restitution > 0.0 and -was > BOUNCES * abs(will - was) and was < 0.0:
                given = restitution * was
            program[c + AT_GIVEN], program[c + AT_GIVEN + 1], program[c + AT_GIVEN + 2] = (
                given * nx,
                given * ny,
                given * nz,
            )
            for j in range(3):
                program[c + AT_IMPULSE + j] = 0.0
                floats[ints[POINTS_AT] + 3 * contacts + j] = points[at + j]
            floats[ints[NORMALS_AT] + 3 * contacts] = nx
            floats[ints[NORMALS_AT] + 3 * contacts + 1] = ny
            floats[ints[NORMALS_AT] + 3 * contacts + 2] = nz
            contacts += 1
    floats[ints[COUNT_AT]] = contacts
    floats[ints[CROWDED_AT]] += crowded
    if contacts == 0:
        return
    plan[CONTACTS] = contacts
    if solve(program, plan) != SOLVED:
        floats[ints[LOOSE_AT]] += 1.0
    touched = np.zeros(n)
    for k in range(contacts):
        c = plan[CONTACTS_AT] + CONTACT * k
        pushed = 0.0
        for j in range(3):
            floats[ints[FORCES_AT] + 3 * k + j] = program[c + AT_IMPULSE + j] / h
            pushed += abs(program[c + AT_IMPULSE + j])
        if pushed > 0.0:
            pair = plan[plan[CONTACT_INTS_AT] + k]
            first = n * (n - 1) // 2
            if pair >= first:
                touched[pair - first] = 1.0
            else:
                a = 0
                while pair >= n - 1 - a:
                    pair -= n - 1 - a
                    a += 1
                touched[a] = touched[a + 1 + pair] = 1.0
    for k in range(n):
        if touched[k] == 0.0:
            continue
        own, body = ints[BODIES_AT] + BODY_INTS * k, BODY * k
        move(h, y0, y1, floats, ints, own, program, body, before, MOTION * k)
