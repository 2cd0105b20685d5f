# mypy: ignore-errors
"""Masses among the contacts of rigid bodies (rigid_local_kernels), compiled where there are any.

A mass is a body that does not turn; what acts on it acts at its center, and on the body at the same place, which keeps
momentum and angular momentum to rounding. It meets the surface of a shape (contacts/shape_kernels.py) on its path in
the axes that the body has at the start of the step.
"""

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.bodies.rigid.point_list import (
    AT_ARM_A,
    AT_ARM_B,
    AT_GIVEN,
    AT_LED,
    AT_NORMAL,
    AT_POINT,
    AT_PUSH,
    BODY_A,
    BODY_B,
    FIRST_NAME,
    LAST_NAME,
    WHERE,
    WHO,
)
from sceneql.bodies.rigid.rigid_kernels import to_body, to_world
from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.body_path_kernels import NEVER, first_contact, moving, place
from sceneql.contacts.distance.mass_near_kernels import (
    FIRST,
    HEAD,
    INVERSE,
    MASS,
    MEMORY_AT,
    NUMBER,
    OBJECT_AT,
    POSITION,
    RADIUS,
    TALLY_AT,
    VELOCITY,
    WORK,
    candidates,
    reach_to,
    seen_from,
    set_path,
    size_of,
)
from sceneql.contacts.distance.rigid_layout import BODIES, MASSES_AT, RESTITUTION_AT, SHAPES
from sceneql.contacts.distance.rigid_rows_kernels import BOUNCES, MOTION, PLACE, speed_along, with_room
from sceneql.contacts.impact_kernels import MOST_CUTS, count_hit
from sceneql.contacts.shape_kernels import surface
from sceneql.system.signatures_kernels import A, F, I, N

LONGEST, LONGER = 3, 4
"""In the memory: the longest step in which springs of masses are stable beside contacts, whose impulses the solver does
not see; the steps that were longer while masses on springs touched something."""
ROUNDED = 1.02
"""How much longer a step may be, which is stretched to the end of the run, or rounded."""
FEW = 8
"""Masses with an impact in a step above which it is not cut at the first."""
SHORT = 1e-3
"""Part of the way to an impact by which a cut step ends before it."""
DEEP, ROUGH = 1e-7, 1e-3
"""Parts of its radius, or of the body's reach: by which a mass may be inside at the end of a step, and within which it
touches in any case."""
BOUNCED = 1
"""Name of a contact that is an impact."""


@lean_inlined
def approach(speeds, number, rx, ry, rz, where, to):
    """The normal velocity of a body's place against a mass that is held."""
    q = MOTION * number
    ux = speeds[q] + speeds[q + 4] * rz - speeds[q + 5] * ry - where[to + AT_LED]
    uy = speeds[q + 1] + speeds[q + 5] * rx - speeds[q + 3] * rz - where[to + AT_LED + 1]
    uz = speeds[q + 2] + speeds[q + 3] * ry - speeds[q + 4] * rx - where[to + AT_LED + 2]
    return where[to + AT_NORMAL] * ux + where[to + AT_NORMAL + 1] * uy + where[to + AT_NORMAL + 2] * uz


@lean(types.void(F, A, I, A, A, A, N, N, N, N, F, F, F, F, F, A, A, I, A, N), inner=True)
def write(
    h, floats, ints, y0, y1, places, mass, model, number, ahead, s, gap, nx, ny, nz, motions, before, who, where, c
):  # fmt: skip
    """Write point c of the list: a mass that meets a shape at s of its path, or, ``ahead``, is too deep at its end."""
    own, k, n = ints[MASSES_AT], mass - ints[model + FIRST], ints[BODIES]
    x, p, to, name = ints[model + POSITION] + 3 * k, PLACE * number, WHERE * c, WHO * c
    rx, ry, rz = y0[x] - places[p], y0[x + 1] - places[p + 1], y0[x + 2] - places[p + 2]
    still = floats[ints[model + INVERSE] + k] == 0.0
    for j in range(WHERE):
        where[to + j] = 0.0
    sign = -1.0 if still else 1.0
    where[to + AT_NORMAL], where[to + AT_NORMAL + 1], where[to + AT_NORMAL + 2] = sign * nx, sign * ny, sign * nz
    arm = to + (AT_ARM_A if still else AT_ARM_B)
    where[arm], where[arm + 1], where[arm + 2] = rx, ry, rz
    radius = floats[ints[model + RADIUS] + k]
    where[to + AT_POINT], where[to + AT_POINT + 1] = y0[x] - radius * nx, y0[x + 1] - radius * ny
    where[to + AT_POINT + 2] = y0[x + 2] - radius * nz
    b = number
    who[name + FIRST_NAME], who[name + LAST_NAME] = 0, 0
    if still:  # it stands in the way: the body is the first of the two
        who[name + BODY_A], who[name + BODY_B] = number, ints[SHAPES] + mass
        for j in range(3):
            where[to + AT_LED + j] = (y1[x + j] - y0[x + j]) / h
        will, was = approach(motions, number, rx, ry, rz, where, to), approach(before, number, rx, ry, rz, where, to)
    else:
        who[name + BODY_A], who[name + BODY_B] = mass, number
        will = speed_along(motions, mass, b, 0.0, 0.0, 0.0, rx, ry, rz, nx, ny, nz)
        was = speed_along(before, mass, b, 0.0, 0.0, 0.0, rx, ry, rz, nx, ny, nz)
        if number >= n:
            q = MOTION * b
            where[to + AT_LED] = motions[q] + motions[q + 4] * rz - motions[q + 5] * ry
            where[to + AT_LED + 1] = motions[q + 1] + motions[q + 5] * rx - motions[q + 3] * rz
            where[to + AT_LED + 2] = motions[q + 2] + motions[q + 3] * ry - motions[q + 4] * rx
    where[to + AT_GIVEN] = gap / h - (will if ahead == 1 else 0.0)
    restitution = floats[ints[RESTITUTION_AT]]
    hits = was + s * (will - was)
    whole = max(h, floats[ints[own + MEMORY_AT] + layout.WHOLE])
    if ahead == 0 and restitution > 0.0 and -hits > BOUNCES * abs(will - was) * whole / h:
        # The forces of the rest of the step act on it after the impact.
        where[to + AT_GIVEN] = min(where[to + AT_GIVEN], restitution * hits - (1.0 - s) * (will - was))
        who[name + FIRST_NAME] = BOUNCED


@lean_inlined
def is_led(ints, who, j, mass, number):
    """Whether point j of the list is of this mass and this shape."""
    a, b = who[WHO * j + BODY_A], who[WHO * j + BODY_B]
    return (a == mass and b == number) or (a == number and b == ints[SHAPES] + mass)


@lean_inlined
def owner(ints, who, j):
    """The mass of point j of the list."""
    b = who[WHO * j + BODY_B]
    return b - ints[SHAPES] if b >= ints[SHAPES] else who[WHO * j + BODY_A]


@kernel(I(I, N, I))
def of_masses(who, contacts, ints):
    """The points of the list that are of masses, by mass."""
    own = ints[MASSES_AT]
    first = ints[own + HEAD + FIRST]
    counts, some = filled(ints[BODIES] - first + 1, 0), 0
    for j in range(contacts):
        if owner(ints, who, j) >= first and owner(ints, who, j) < ints[BODIES]:
            counts[owner(ints, who, j) - first + 1] += 1
            some += 1
    for k in range(1, counts.size):
        counts[k] += counts[k - 1]
    found = filled(some, 0)
    for j in range(contacts):
        mass = owner(ints, who, j)
        if mass >= first and mass < ints[BODIES]:
            found[counts[mass - first]] = j
            counts[mass - first] += 1
    return found


@kernel(types.Tuple((I, A, N))(F, A, I, A, A, A, A, A, A, N, I, A, N))
def mass_points(h, floats, ints, y0, y1, places, ends, motions, before, number, who, where, contacts):
    """The list of points (rigid_rows_kernels) with those of masses behind.

    In round ``number`` 0 by their motion without contacts; later by that which the impulses found leave: where one
    would pass a surface, or would be too deep in it at the end of the step.
    """
    near = candidates(h, floats, ints, y0, y1, places, motions, before)
    path, mine, before_mass = np.empty(layout.PATH), 0, -1
    known = of_masses(who, contacts, ints) if number > 0 else filled(0, 0)
    for c in range(near.size // 3):
        mass, model, record = near[3 * c], near[3 * c + 1], near[3 * c + 2]
        k, shape = mass - ints[model + FIRST], ints[record + NUMBER]
        at, reach = ints[record + OBJECT_AT], reach_to(floats, ints, model, k)
        x, v = ints[model + POSITION] + 3 * k, ints[model + VELOCITY] + 3 * k
        straight = 1 if number > 0 else 0
        set_path(h, y0, y1, places, ends, x, v, shape, motions, before, straight, path)
        ahead, gap, s = 0, 0.0, 0.0
        nx, ny, nz = 0.0, 0.0, 0.0
        if number > 0:
            if mass != before_mass:
                while mine < known.size and owner(ints, who, known[mine]) < mass:
                    mine += 1
                before_mass = mass
            j, has = mine, False
            while j < known.size and owner(ints, who, known[j]) == mass:
                has |= is_led(ints, who, known[j], mass, shape)
                j += 1
            if has:
                d, nx, ny, nz = surface(floats, ints, at, path[6], path[7], path[8])
                gap = d - reach
                if gap >= -DEEP * size_of(floats, ints, model, k, shape):
                    continue
                begun = surface(floats, ints, at, path[0], path[1], path[2])[0] - reach
                if gap >= begun - DEEP * size_of(floats, ints, model, k, shape):
                    continue  # it began as deep: `push_out` is for it
                gap -= min(begun, 0.0)
                ahead = 1
                p = PLACE * shape
                nx, ny, nz = to_world(ends, p + 3, *to_body(places, p + 3, nx, ny, nz))
        if ahead == 0:
            # What is as near as to rest comes nearer, too, once something else holds the body.
            d, nx, ny, nz = surface(floats, ints, at, path[0], path[1], path[2])
            if number > 0 or d - reach > ROUGH * size_of(floats, ints, model, k, shape):
                s = first_contact(path, floats, ints, at, reach)
                if s == NEVER:
                    continue
            px, py, pz = place(path, s)
            d, nx, ny, nz = surface(floats, ints, at, px, py, pz)
            gap = nx * (path[0] - px) + ny * (path[1] - py) + nz * (path[2] - pz) + d - reach
            if gap < -DEEP * size_of(floats, ints, model, k, shape):
                gap = 0.0
        who, where = with_room(who, where, contacts)
        write(
            h, floats, ints, y0, y1, places, mass, model, shape, ahead, s, gap, nx, ny, nz, motions, before,
            who, where, contacts,
        )  # fmt: skip
        contacts += 1
    return who, where, contacts


@kernel(types.void(F, F, A, I, A, A, A, A, A, A))
def cut_at_impact(t0, t1, floats, ints, y0, y1, places, ends, motions, before):
    """Let the step end right before the first impact of a mass, where there are few."""
    memory, h = ints[ints[MASSES_AT] + MEMORY_AT], t1 - t0
    if t1 > floats[memory + layout.END]:
        floats[memory + layout.END], floats[memory + layout.WHOLE], floats[memory + layout.CUTS] = t1, h, 0.0
    if not floats[memory + layout.CUTS] < MOST_CUTS:
        return
    near = candidates(h, floats, ints, y0, y1, places, motions, before)
    path, least, hits = np.empty(layout.PATH), 1.0, 0
    for c in range(near.size // 3):
        mass, model, record = near[3 * c], near[3 * c + 1], near[3 * c + 2]
        k, shape = mass - ints[model + FIRST], ints[record + NUMBER]
        at, reach = ints[record + OBJECT_AT], reach_to(floats, ints, model, k)
        x, v = ints[model + POSITION] + 3 * k, ints[model + VELOCITY] + 3 * k
        set_path(h, y0, y1, places, ends, x, v, shape, motions, before, 0, path)
        s = first_contact(path, floats, ints, at, reach)
        if s == NEVER or s < 2.0 * SHORT:
            continue
        _, nx, ny, nz = surface(floats, ints, at, *place(path, s))
        ux, uy, uz = moving(path, s)
        change = nx * (path[9] - path[3]) + ny * (path[10] - path[4]) + nz * (path[11] - path[5])
        if -(nx * ux + ny * uy + nz * uz) > BOUNCES * abs(change) * floats[memory + layout.WHOLE] / h:
            hits += 1
            least = min(least, s)
    if 0 < hits <= FEW:
        floats[memory + layout.CUTS] += 1.0
        floats[channels.STEP_END] = min(floats[channels.STEP_END], t0 + (1.0 - SHORT) * least * h)


@kernel(types.void(F, A, I, A, A, A, A, A, A))
def push_out(h, floats, ints, y0, y1, places, ends, motions, before):
    """Move masses out of what they began in, as where their radii reach into it at the start, without a velocity."""
    near = candidates(h, floats, ints, y0, y1, places, motions, before)
    for c in range(near.size // 3):
        model, record = near[3 * c + 1], near[3 * c + 2]
        k, p = near[3 * c] - ints[model + FIRST], PLACE * ints[record + NUMBER]
        if floats[ints[model + INVERSE] + k] == 0.0:
            continue
        x, at = ints[model + POSITION] + 3 * k, ints[record + OBJECT_AT]
        u, v, w = seen_from(places, ends, p, y1[x] - ends[p], y1[x + 1] - ends[p + 1], y1[x + 2] - ends[p + 2])
        d, nx, ny, nz = surface(floats, ints, at, places[p] + u, places[p + 1] + v, places[p + 2] + w)
        d -= reach_to(floats, ints, model, k)
        if d < -DEEP * size_of(floats, ints, model, k, ints[record + NUMBER]):
            n = to_world(ends, p + 3, *to_body(places, p + 3, nx, ny, nz))
            of = MOTION * near[3 * c]
            for j in range(3):
                y1[x + j] -= d * n[j]
                force = floats[ints[model + MASS] + k] * (motions[of + j] - before[of + j]) / h
                y1[ints[model + WORK]] -= d * n[j] * force


@kernel(types.void(F, F, A, I, A, I, A, N))
def tally(t, h, floats, ints, before, who, where, contacts):
    """Count the impacts of masses, and steps too long for their springs."""
    n, at, touching = ints[BODIES], ints[ints[MASSES_AT] + TALLY_AT], 0.0
    memory = ints[ints[MASSES_AT] + MEMORY_AT]
    first = ints[ints[MASSES_AT] + HEAD + FIRST]
    for j in range(contacts):
        to, a, b = WHERE * j, who[WHO * j + BODY_A], who[WHO * j + BODY_B]
        mine = a >= first or b >= ints[SHAPES]
        push = abs(where[to + AT_PUSH]) + abs(where[to + AT_PUSH + 1]) + abs(where[to + AT_PUSH + 2])
        if mine and push > 0.0 and h > ROUNDED * floats[memory + LONGEST]:
            touching = 1.0
        if not mine or who[WHO * j + FIRST_NAME] != BOUNCED or push == 0.0:
            continue
        arm = to + AT_ARM_A
        if b >= n and a < first:
            speed = approach(before, a, where[arm], where[arm + 1], where[arm + 2], where, to)
        else:
            arm = to + AT_ARM_B
            speed = speed_along(
                before, a, b, 0.0, 0.0, 0.0, where[arm], where[arm + 1], where[arm + 2],
                where[to + AT_NORMAL], where[to + AT_NORMAL + 1], where[to + AT_NORMAL + 2],
            )  # fmt: skip
        count_hit(floats, at, t, -speed)
    floats[memory + LONGER] += touching
