# mypy: ignore-errors
"""The end of a step with local contacts inside the stages of Newton's method (stage_contacts_kernels).

Masses that a stage has stopped on a surface have their impact now: they leave with the restitution, or rest. Masses
that may touch a surface in the next step are listed for its stages. An impact of a mass that was not listed is resolved
as where contacts act between steps alone (respond_kernels).
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout
from sceneql.contacts.back_off_kernels import find_near
from sceneql.contacts.body_path_kernels import MEAN, NEVER, set_out
from sceneql.contacts.impact_kernels import bounce, count_hit, scale_of
from sceneql.contacts.meet_kernels import earliest
from sceneql.contacts.pair_kernels import ANSWER, BACK_OFF_IN_STAGES, body_of
from sceneql.contacts.resting_kernels import come_to_rest, set_velocity
from sceneql.contacts.shape_kernels import near_at, surface, velocity
from sceneql.system.signatures_kernels import A, F, I, N

back_off_found = lazy("sceneql.contacts.respond_kernels:back_off_found", ANSWER)

AHEAD = 3.0
"""Steps at the present speed within which a mass has to come near a surface to be listed."""
TOUCH = 1e-9
"""Depth, relative to the coordinates (or to a meter), from which on a mass at a step's end is moved outside."""


@lean_inlined
def whole_way(path):
    """Distance [m] between the ends of a path."""
    return math.sqrt((path[6] - path[0]) ** 2 + (path[7] - path[1]) ** 2 + (path[8] - path[2]) ** 2)


@lean(types.void(F, A, A, A, A, A, A, A, I), inner=True)
def find_missed(h, y0, y1, found, listed, path, mean, floats, ints):
    """Leave found[k] = 1 for masses that met a surface without having been stopped there by a stage."""
    find_near(h, y0, y1, found, floats, ints)
    thinnest = math.inf
    for j in range(ints[layout.OBJECTS]):
        thinnest = min(thinnest, floats[ints[layout.HEAD + layout.OBJECT * j + layout.DEPTH]])
    for k in range(ints[layout.BODIES]):
        if found[k] == 0.0:
            continue
        set_out(k, h, y0, y1, path, mean, ints)
        reach = floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
        held = False
        for j in range(ints[layout.OBJECTS]):
            held = held or floats[ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j) + layout.LOAD] > 0.0
        if listed[k] != 0.0 and (held or whole_way(path) < thinnest):
            found[k] = 0.0
        elif earliest(k, reach, path, floats, ints)[0] == NEVER:
            found[k] = 0.0


@lean(types.void(F, F, N, N, A, A, A, I), inner=True)
def arrive(t1, h, k, j, y0, y1, floats, ints):
    """The impact of a pair that a stage of the step of length h has stopped, or the beginning of its rest.

    The energy of approach that the stages took, and the work of other forces along the normal, are counted here: the
    loads at the ends of stages give them with an error as large as the impact.
    """
    memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
    at = layout.HEAD + layout.OBJECT * j
    reach = floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
    px, py, pz, vx, vy, vz = body_of(ints, k, y1)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
    qx, qy, qz, wx, wy, wz = body_of(ints, k, y0)
    before = (wx - ux) * nx + (wy - uy) * ny + (wz - uz) * nz
    rx, ry, rz = vx - ux, vy - uy, vz - uz
    now = rx * nx + ry * ny + rz * nz
    rx, ry, rz = rx - now * nx, ry - now * ny, rz - now * nz
    if before < 2.0 * min(0.0, floats[memory + layout.PRESS]) * h:
        gap = surface(floats, ints, at, qx, qy, qz)[0] - reach
        count_hit(floats, ints[layout.TALLY], t1 - h * max(0.0, 1.0 + gap / (before * h)), -before)
        rx, ry, rz = rx + before * nx, ry + before * ny, rz + before * nz
        rx, ry, rz = bounce(rx, ry, rz, nx, ny, nz, floats[ints[layout.RESTITUTION]], floats[ints[layout.FRICTION]])
    if before >= 0.0 or floats[ints[layout.RESTITUTION]] == 0.0 or rx * nx + ry * ny + rz * nz <= 0.0:
        come_to_rest(t1, memory, rx, ry, rz, nx, ny, nz, floats, ints)
    set_velocity(k, rx + ux, ry + uy, rz + uz, y1, floats, ints)
    way = (px - qx - h * ux) * nx + (py - qy - h * uy) * ny + (pz - qz - h * uz) * nz
    stopped = 0.5 * (before * before - now * now) + floats[memory + layout.PRESS] * way
    y1[ints[layout.WORK]] += floats[ints[layout.MASS] + k] * stopped


@lean(types.void(F, F, N, N, A, A, A, I), inner=True)
def put_right(t1, h, k, j, y0, y1, floats, ints):
    """Update a listed pair after a step of length h: its impact, rest or release; then move the mass outside."""
    memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
    at = layout.HEAD + layout.OBJECT * j
    load = floats[memory + layout.LOAD]
    if floats[memory + layout.TIED] > 0.0 and floats[memory] == layout.FREE:
        arrive(t1, h, k, j, y0, y1, floats, ints)
        floats[memory + layout.EARLIER] = max(0.0, -floats[memory + layout.PRESS])
        floats[memory + layout.TIED] = 0.0 if floats[memory] == layout.FREE else 1.0
    elif load > 0.0:
        px, py, pz, vx, vy, vz = body_of(ints, k, y1)
        _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
        ux, uy, uz = velocity(floats, ints, at, px, py, pz)
        come_to_rest(t1, memory, vx - ux, vy - uy, vz - uz, nx, ny, nz, floats, ints)
        floats[memory + layout.EARLIER] = load
    else:
        floats[memory], floats[memory + layout.TIED] = layout.FREE, 0.0
    px, py, pz, _, _, _ = body_of(ints, k, y1)
    d, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    d -= floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
    if d < -TOUCH * scale_of(px, py, pz):
        to = ints[layout.POSITION] + 3 * k
        y1[to], y1[to + 1], y1[to + 2] = px - d * nx, py - d * ny, pz - d * nz
        y1[ints[layout.WORK]] -= floats[ints[layout.MASS] + k] * min(0.0, floats[memory + layout.PRESS]) * d


@lean(types.void(F, A, A, A, A, A, I), inner=True)
def list_near(h, y0, y1, found, ahead, floats, ints):
    """List the pairs that may touch in the next step, and the masses that have one.

    ``found`` (bodies,) and ``ahead`` (3 bodies,) are scratch.
    """
    n, objects = ints[layout.BODIES], ints[layout.OBJECTS]
    at, to = ints[layout.POSITION], ints[layout.VELOCITY]
    x1, v1 = y1[at : at + 3 * n], y1[to : to + 3 * n]
    change = 0.0
    for c in range(3 * n):
        change = max(change, abs(v1[c] - y0[to + c]))
        ahead[c] = x1[c] + AHEAD * h * v1[c]
    more = floats[ints[layout.THICKNESS]] + 2.0 * h * change
    radii = floats[ints[layout.RADIUS] : ints[layout.RADIUS] + n]
    for j in range(objects):
        place = layout.HEAD + layout.OBJECT * j
        moving = ints[place + layout.MOVING] != 0
        for k in range(n):
            found[k] = 1.0 if moving else 0.0
        if not moving:
            near_at(ints[place + layout.NEAR])(floats, ints, place, AHEAD * h, x1, v1, ahead, v1, radii, more, found)
        for k in range(n):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
            floats[memory + layout.LISTED] = 1.0 if floats[memory] != layout.FREE else found[k]
    count = 0
    for k in range(n):
        listed = False
        for j in range(objects):
            listed = listed or floats[ints[layout.PAIRS] + layout.PAIR * (k * objects + j) + layout.LISTED] != 0.0
        if listed and floats[ints[layout.INVERSE] + k] != 0.0:
            floats[ints[layout.LAST] + layout.LIST + count] = k
            count += 1
    floats[ints[layout.LAST] + layout.RESTING] = count


@kernel(BACK_OFF_IN_STAGES, inner=True)
def back_off_in_stages(t0, t1, y0, y1, floats, ints):
    """Resolve in y1 the impacts of the step from t0 to t1, and list the masses that may touch in the next one."""
    h = t1 - t0
    found, listed = np.zeros(ints[layout.BODIES]), np.zeros(ints[layout.BODIES])
    path, mean = np.empty(layout.PATH), np.empty(MEAN)
    for i in range(int(floats[ints[layout.LAST] + layout.RESTING])):
        listed[int(floats[ints[layout.LAST] + layout.LIST + i])] = 1.0
    find_missed(h, y0, y1, found, listed, path, mean, floats, ints)
    missed = False
    for k in range(found.size):
        missed = missed or found[k] != 0.0
    if missed:
        floats[ints[layout.LAST] + layout.WHOLE] = h
        back_off_found(t0, t1, y0, y1, found, path, mean, floats, ints)
    for k in range(ints[layout.BODIES]):
        if listed[k] != 0.0 and found[k] == 0.0:
            for j in range(ints[layout.OBJECTS]):
                put_right(t1, h, k, j, y0, y1, floats, ints)
    list_near(h, y0, y1, found, np.empty(3 * found.size), floats, ints)
