# mypy: ignore-errors
"""Contacts in `exact` mode: gaps and impacts for event location.

A resting pair with friction slides until its speed along the last direction is zero, which is an event as well. A
body's memory in the floats: the last accepted instant, its place and velocity then (INSTANT).
"""

import numpy as np

import sceneql.system.channels as channels
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout
from sceneql.contacts.body_path_kernels import NEVER, first_contact, moving, place
from sceneql.contacts.pair_kernels import KEEP, SUPPORT, away, body_of
from sceneql.contacts.shape_kernels import FROM_TYPE, surface, velocity
from sceneql.system.signatures_kernels import GAP, IMPACT, TERM

hit = lazy("sceneql.contacts.hit_kernels:hit", IMPACT)
keep = lazy("sceneql.contacts.resting_kernels:keep", KEEP)
from_object = lazy("sceneql.contacts.moving_kernels:from_object", FROM_TYPE)
support = lazy("sceneql.contacts.support_kernels:support", SUPPORT)

NO_EVENT = 1e300


@lean_inlined
def swept(t, k, at, x, y, z, vx, vy, vz, distance, reach, path, floats, ints):
    """The gap [m]; negative also where the path since the last accepted instant passed through the object."""
    last = ints[layout.LAST] + layout.INSTANT * k
    gap = distance - reach
    if not t > floats[last]:
        return gap
    for c in range(6):
        path[c] = floats[last + 1 + c]
    path[6], path[7], path[8], path[9], path[10], path[11] = x, y, z, vx, vy, vz
    path[12] = t - floats[last]
    if ints[at + layout.MOVING] != 0:
        # Require a depth beyond the error of the path.
        off = from_object(floats, ints, at, path)
        if not off < 0.5 * (floats[ints[at + layout.DEPTH]] + reach):
            return gap
        reach -= off
    s = first_contact(path, floats, ints, at, reach)
    if s == NEVER or s == 1.0:
        return gap
    px, py, pz = place(path, s)
    ux, uy, uz = moving(path, s)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    approach = min(-1e-9, ux * nx + uy * ny + uz * nz)
    return min(gap, approach * (1.0 - s) * path[12])


@kernel(GAP, inner=True)
def gap(t, y, gaps, floats, ints):
    """Gaps of all pairs: signed distance [m]; speed [m/s] of a sliding pair; 1e300 for a resting or fixed one."""
    objects = ints[layout.OBJECTS]
    path = np.empty(layout.PATH)
    for k in range(ints[layout.BODIES]):
        px, py, pz, vx, vy, vz = body_of(ints, k, y)
        reach = floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
        for j in range(objects):
            pair = k * objects + j
            memory = ints[layout.PAIRS] + layout.PAIR * pair
            at = layout.HEAD + layout.OBJECT * j
            gaps[pair] = NO_EVENT
            if floats[ints[layout.INVERSE] + k] == 0.0 or floats[memory] == layout.STICKS:
                continue
            if floats[memory] == layout.SLIDES:
                if floats[ints[layout.FRICTION]] > 0.0:
                    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
                    slide = memory + layout.ALONG
                    ax, ay, az = floats[slide], floats[slide + 1], floats[slide + 2]
                    gaps[pair] = (vx - ux) * ax + (vy - uy) * ay + (vz - uz) * az
                continue
            d = surface(floats, ints, at, px, py, pz)[0]
            gaps[pair] = swept(t, k, at, px, py, pz, vx, vy, vz, d, reach, path, floats, ints)


@lean_inlined
def note_instant(t, k, y, floats, ints):
    """Store place and velocity of body k at an accepted instant."""
    last = ints[layout.LAST] + layout.INSTANT * k
    floats[last] = t
    for c in range(3):
        floats[last + 1 + c] = y[ints[layout.POSITION] + 3 * k + c]
        floats[last + 4 + c] = y[ints[layout.VELOCITY] + 3 * k + c]


@lean_inlined
def hold(t, y, floats, ints):
    """Keep resting bodies on their surfaces, release those that have left, and store the accepted instant."""
    for k in range(ints[layout.BODIES]):
        for j in range(ints[layout.OBJECTS]):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
            if floats[memory] != layout.FREE and keep(t, k, j, y, floats, ints):
                floats[channels.CHANGED] = 1.0
        note_instant(t, k, y, floats, ints)


@lean(IMPACT, inner=True)
def impact(t, y, pair, floats, ints):
    """The impulse of a pair at its impact, or the end of its sliding; pair -1: `hold`."""
    if pair < 0:
        hold(t, y, floats, ints)
    else:
        hit(t, y, pair, floats, ints)
        note_instant(t, pair // ints[layout.OBJECTS], y, floats, ints)


@lean_inlined
def first_near(y, floats, ints):
    """The first body that rests, or is near enough to an object to need its free normal acceleration; -1 for none."""
    for k in range(ints[layout.BODIES]):
        if floats[ints[layout.INVERSE] + k] == 0.0:
            continue
        for j in range(ints[layout.OBJECTS]):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
            if floats[memory] != layout.FREE or not away(k, j, y, floats, ints):
                return k
    return -1


@lean(TERM, inner=True)
def constrain(t, y, rate, floats, ints):
    """Add normal and friction forces to the accelerations; impacts need the free normal accelerations, too."""
    first = first_near(y, floats, ints)
    if first >= 0:
        support(first, y, rate, floats, ints)
