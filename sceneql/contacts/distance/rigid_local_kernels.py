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
from sceneql.bodies.rigid.groups_kernels import MASS, solve_groups
from sceneql.bodies.rigid.moved_bodies_kernels import (
    ROW_BODIES_AT,
    ROWS,
    again,
    begin_ties,
    end_ties,
    first_stop,
    move_all,
    place_all,
    rouse,
    strike,
    tell_work,
    tied_to,
    write_ties,
)
from sceneql.bodies.rigid.point_list import AT_NORMAL, AT_POINT, AT_PUSH, BODY_A, BODY_B, WHERE, WHO
from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS, gather
from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel, lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.manifold_kernels import MOST, NAME, POINT, manifold
from sceneql.contacts.distance.near_shapes_kernels import (
    is_skinned,
    joined,
    pairs_of,
    reach_of,
    speed_at,
    sweep,
)
from sceneql.contacts.distance.rigid_layout import (
    ALL_BODIES,
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
    MASSES_AT,
    MOST_KEPT,
    NORMALS_AT,
    PLACES_AT,
    POINTS_AT,
    RESTITUTION_AT,
    ROLLING_AT,
    ROOM,
    ROOM_AT,
    SHAPES,
    SHAPES_AT,
    SKINS_AT,
    TIES,
    TIES_AT,
)
from sceneql.contacts.distance.rigid_rows_kernels import MOTION, PLACE, add_points, note_places, recall, with_room
from sceneql.contacts.distance.swept_boxes_kernels import BOX
from sceneql.linear.cones.cone_layout_kernels import ROW
from sceneql.system.signatures_kernels import BACK_OFF, A, F, I, N

TOUCH, ROLLING = "sceneql.contacts.distance.first_touch_kernels", "sceneql.contacts.distance.rolling_kernels"
first_touch = lazy(f"{TOUCH}:first_touch", F(A, I, N, N, A, N, N, A, N, N, F, F, F, A))
place_after = lazy(f"{TOUCH}:move", types.void(A, N, A, N, F, A, N))
solve_rolling = lazy(f"{ROLLING}:solve_rolling", N(N, N, I, A, N, A, A, A, A, A, F, F, A, I, I, N))
lead = lazy("sceneql.contacts.distance.led_kernels:lead", types.void(F, F, A, I, N, A, N, A, N))
SKINS = "sceneql.contacts.distance.skin_pair_kernels"
skin_points = lazy(f"{SKINS}:skin_points", types.Tuple((I, A, N))(F, A, I, N, N, A, A, A, F, N, I, A, N))
nearing = lazy(f"{SKINS}:nearing", F(A, I, A, A, N, N))
shortened = lazy(f"{SKINS}:shortened", F(F, A, I, A, A, A, types.int64[:, ::1]))
MASSES = "sceneql.contacts.distance.mass_points_kernels"
mass_points = lazy(f"{MASSES}:mass_points", types.Tuple((I, A, N))(F, A, I, A, A, A, A, A, A, N, I, A, N))
cut_at_impact = lazy(f"{MASSES}:cut_at_impact", types.void(F, F, A, I, A, A, A, A, A, A))
push_out = lazy(f"{MASSES}:push_out", types.void(F, A, I, A, A, A, A, A, A))
tally = lazy(f"{MASSES}:tally", types.void(F, F, A, I, A, I, A, N))

LAZY_FIRST = (
    "sceneql.contacts.distance.separation_kernels",
    "sceneql.contacts.distance.overlay_kernels",
    "sceneql.linear.cones.cone_few_kernels",
    TOUCH,
    "sceneql.linear.cones.cone_kernels",
)
"""Lazily compiled modules with which a background process begins (driver.lazy_first)."""
ROUNDS = 12
"""Most solutions of a step."""
DEEP = 1e-7
"""Part of a body's reach by which it may be inside another at the end of a step without another solution."""
STILL = 1e-9
"""Part of a body's reach by which it may move against another in a step that leaves their contacts as they are."""


@kernel(A(A), inner=True)
def copied(numbers):
    """A copy."""
    found = np.empty(numbers.size)
    for k in range(numbers.size):
        found[k] = numbers[k]
    return found


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
        if joined(ints, a, b):
            continue
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
        if joined(ints, a, b):
            continue
        one, two, reach = head + SHAPE * a, head + SHAPE * b, floats[ints[head + SHAPE * a + 1] + 1]
        if b < n:
            reach = min(reach, floats[ints[head + SHAPE * b + 1] + 1])
        if is_skinned(ints, a, b):
            if h * nearing(floats, ints, places, motions, a, b) <= STILL * reach:
                continue
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
    """Resolve the contacts of the step in y1, with the ties of what touches.

    While STEP_END is above 0, only lower it: to where a tie comes to its stop, or where skins would come too fast.
    """
    h, n, shapes, every, bodies_at = t1 - t0, ints[BODIES], ints[SHAPES], ints[ALL_BODIES], ints[BODIES_AT]
    ties = ints[ints[TIES_AT] : ints[TIES_AT] + ints[TIES]]
    tied = ties.size > 0
    asked = floats[channels.STEP_END] > 0.0
    if asked and tied:
        part = first_stop(h, y0, y1, floats, ties)
        if part < 1.0:
            floats[channels.STEP_END] = min(floats[channels.STEP_END], t0 + part * h)
    if asked and ints[SKINS_AT] == 0 and ints[MASSES_AT] == 0:
        return
    places = floats[ints[PLACES_AT] : ints[PLACES_AT] + PLACE * shapes]
    room = floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]]
    size = MOTION * max(shapes, every)
    motions, before, masses = np.zeros(size), np.zeros(size), np.empty(MASS * every)
    boxes = np.empty(BOX * shapes)
    note_places(y0, places, ints, 0)
    # What stands has the numbers behind the bodies with shapes: those without one come once that is looked at.
    for k in range(n):
        gather(y0, y0, y1, floats, ints, bodies_at + BODY_INTS * k, masses, MASS * k, motions, before, MOTION * k)
    seen, ends = np.zeros(MOTION * shapes), copied(places)
    for k in range(ints[LEDS]):
        own = ints[LEDS_AT] + LED * k
        at = ints[own]
        lead(t0, t1, floats, ints, own + 1, places, PLACE * at, motions, MOTION * at)
        place_after(places, PLACE * at, motions, MOTION * at, h, ends, PLACE * at)
        for c in range(MOTION):
            before[MOTION * at + c] = seen[MOTION * at + c] = motions[MOTION * at + c]
    sweep(h, floats, ints, places, motions, before, 1e-3, boxes, room)
    pairs, some_masses = pairs_of(boxes, shapes), ints[MASSES_AT] > 0
    if some_masses:
        note_places(y1, ends, ints, 1)
    if asked:
        if some_masses:
            cut_at_impact(t0, t1, floats, ints, y0, y1, places, ends, motions, before)
        if ints[SKINS_AT] == 0:
            return
        most = shortened(h, floats, ints, places, motions, before, pairs)
        if most < 0.999 * h:
            # In equal parts: a gap known to rounding, over a short rest, would be a velocity that is not.
            floats[channels.STEP_END] = min(floats[channels.STEP_END], t0 + h / math.ceil(h / most))
        return
    who, where, contacts = contacts_at_start(h, floats, ints, places, motions, before, pairs, room)
    kept = int(floats[ints[COUNT_AT]])
    floats[ints[COUNT_AT]] = 0.0
    if some_masses:
        who, where, contacts = mass_points(
            h, floats, ints, y0, y1, places, ends, motions, before, 0, who, where, contacts
        )
    if pairs.shape[0] == 0 and not tied and contacts == 0:
        return
    names = ints[ints[KEPT_NAMES_AT] : ints[KEPT_NAMES_AT] + WHO * ints[MOST_KEPT]]
    recall(who, where, contacts, names, floats[ints[KEPT_AT] : ints[KEPT_AT] + 3 * ints[MOST_KEPT]], kept)
    free, rows, sides = copied(y1), np.empty(0), ties
    if tied:
        rows = np.zeros(ROW * ties[ROWS])
        sides = ties[ties[ROW_BODIES_AT] : ties[ROW_BODIES_AT] + 2 * ties[ROWS]]
        for k in range(n, every):
            own = bodies_at + BODY_INTS * k
            gather(y0, y0, y1, floats, ints, own, masses, MASS * k, motions, before, MOTION * k)
        begin_ties(h, y0, y1, floats, ties)
        for k in range(contacts):
            rouse(floats, ties, who[WHO * k + BODY_A])
            if who[WHO * k + BODY_B] < n:
                rouse(floats, ties, who[WHO * k + BODY_B])
        strike(y1, floats, masses, ints, ties, bodies_at, motions, before)
        write_ties(h, y0, y1, floats, ties, rows)
    found, touched = copied(before), filled(max(shapes, every), 0)
    for k in range(MOTION * n, MOTION * every):
        found[k] = motions[k]
    first, loose, some = contacts, 0, False
    friction, rolling = floats[ints[FRICTION_AT]], floats[ints[ROLLING_AT]]
    for number in range(ROUNDS):
        if rolling == 0.0 or contacts == 0:
            loose = solve_groups(n, every, who, where, contacts, masses, motions, found, friction, rows, sides)
        else:
            loose = solve_rolling(
                n, every, who, where, contacts, masses, motions, before, seen, found, friction, rolling, rows, sides,
                ints, bodies_at,
            )  # fmt: skip
        for k in range(touched.size):
            touched[k] = 0
        for k in range(contacts):
            at, w = WHERE * k + AT_PUSH, WHO * k
            if where[at] != 0.0 or where[at + 1] != 0.0 or where[at + 2] != 0.0:
                touched[who[w + BODY_A]] = 1
                if who[w + BODY_B] < n:
                    touched[who[w + BODY_B]] = 1
        if tied:
            some = tied_to(touched, floats, ties, rows)
        for k in range(every):
            if touched[k] == 0:
                for c in range(MOTION):
                    found[MOTION * k + c] = motions[MOTION * k + c]
        place_all(h, y0, y1, free, floats, ints, bodies_at, every, ties, touched, found, motions)
        note_places(y1, ends, ints, 1)
        if number == ROUNDS - 1:
            break
        last = contacts
        for k in range(MOTION * n):
            seen[k] = found[k]
        who, where, contacts = contacts_at_end(
            h, floats, ints, places, seen, before, boxes, ends, who, where, contacts, room
        )
        if some_masses:
            who, where, contacts = mass_points(
                h, floats, ints, y0, y1, places, ends, seen, before, number + 1, who, where, contacts
            )
        more = some and again(h, y0, y1, free, floats, ties, rows)
        if contacts == last and not more:
            break
    floats[ints[LOOSE_AT]] += loose > 0
    tell(floats, ints, who, where, first, h)
    if some_masses:
        push_out(h, floats, ints, y0, y1, places, ends, motions, before)
        tally(t0, h, floats, ints, before, who, where, first)
    move_all(y0, y1, free, floats, ints, bodies_at, every, ties, touched, masses, found, before)
    if tied:
        tell_work(floats, ties, rows, found, before)
        end_ties(h, y0, floats, ties, rows, who, where, contacts, n, some)
