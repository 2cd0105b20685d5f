"""Contacts in `exact` mode: gaps and impacts for event location, and resting contact.

A pair is (body k, object j), numbered k * objects + j. Its memory in the floats: state, free normal acceleration, load
(normal force by mass), direction of sliding (3). A body's memory: the last accepted instant, its place and velocity
then. A resting pair with friction slides until its speed along the last direction is zero, which is an event as well.
"""

import math

import numpy as np

from sceneql.kernels import inlined, kernel
from sceneql.simulation.contacts.impulse_kernels import (
    BODIES,
    FRICTION,
    HEAD,
    INVERSE,
    LAST,
    MASS,
    OBJECTS,
    PAIRS,
    POSITION,
    RADIUS,
    REST_TIME,
    RESTITUTION,
    TALLY,
    THICKNESS,
    VELOCITY,
    WORK,
    bounce,
    count_hit,
    scale_of,
)
from sceneql.simulation.contacts.path_kernels import NEVER, PATH, STILL, first_contact, moving, place
from sceneql.simulation.contacts.surface_kernels import (
    MOVING,
    OBJECT,
    acceleration,
    bend,
    surface,
    velocity,
)
from sceneql.system_kernels import GAP, IMPACT, TERM

STATE, PRESS, LOAD, ALONG = 0, 1, 2, 3
PAIR = 6
FREE, SLIDES, STICKS = 0.0, 1.0, 2.0
INSTANT = 7

NO_EVENT = 1e300
NEAR = 1e-9
"""Distance, as a part of the coordinates, within which a free pair's normal acceleration is worth knowing."""

LOWEST_FLIGHT = 4e-13
"""Height of a bounce, as a part of the coordinates, that rounding can still resolve: below it the body rests."""

SWEEPS = 50


@inlined
def body_of(ints, k, y):
    """Place of body k, its velocity, and its reach's offset parts."""
    at = ints[POSITION] + 3 * k
    to = ints[VELOCITY] + 3 * k
    return y[at], y[at + 1], y[at + 2], y[to], y[to + 1], y[to + 2]


@inlined
def swept(t, k, at, x, y, z, vx, vy, vz, distance, reach, path, floats, ints):
    """The gap; negative also where the path since the last accepted instant went through the object."""
    last = ints[LAST] + INSTANT * k
    gap = distance - reach
    if ints[at + MOVING] != 0 or not t > floats[last]:
        return gap
    for c in range(6):
        path[c] = floats[last + 1 + c]
    path[6], path[7], path[8], path[9], path[10], path[11] = x, y, z, vx, vy, vz
    path[12] = t - floats[last]
    s = first_contact(path, floats, ints, at, reach)
    if s == NEVER or s == 1.0:
        return gap
    px, py, pz = place(path, s)
    ux, uy, uz = moving(path, s)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    approach = min(-1e-9, ux * nx + uy * ny + uz * nz)
    return min(gap, approach * (1.0 - s) * path[12])


@kernel(GAP)
def gap(t, y, gaps, floats, ints):
    """Signed distances [m] of all pairs; of a sliding one its speed [m/s]; none for one that rests or is fixed."""
    objects = ints[OBJECTS]
    path = np.empty(PATH)
    for k in range(ints[BODIES]):
        px, py, pz, vx, vy, vz = body_of(ints, k, y)
        reach = floats[ints[RADIUS] + k] + floats[ints[THICKNESS]]
        for j in range(objects):
            pair = k * objects + j
            memory = ints[PAIRS] + PAIR * pair
            at = HEAD + OBJECT * j
            gaps[pair] = NO_EVENT
            if floats[ints[INVERSE] + k] == 0.0 or floats[memory] == STICKS:
                continue
            if floats[memory] == SLIDES:
                if floats[ints[FRICTION]] > 0.0:
                    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
                    ax, ay, az = floats[memory + ALONG], floats[memory + ALONG + 1], floats[memory + ALONG + 2]
                    gaps[pair] = (vx - ux) * ax + (vy - uy) * ay + (vz - uz) * az
                continue
            d = surface(floats, ints, at, px, py, pz)[0]
            gaps[pair] = swept(t, k, at, px, py, pz, vx, vy, vz, d, reach, path, floats, ints)


@inlined
def come_to_rest(memory, vx, vy, vz, nx, ny, nz, floats, ints):
    """Note that a pair rests: sliding along v (relative to the surface), or sticking."""
    vn = vx * nx + vy * ny + vz * nz
    tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    slip = math.sqrt(tx * tx + ty * ty + tz * tz)
    slides = slip > STILL or floats[ints[FRICTION]] == 0.0
    floats[memory] = SLIDES if slides else STICKS
    if slip > 0.0:
        floats[memory + ALONG] = tx / slip
        floats[memory + ALONG + 1] = ty / slip
        floats[memory + ALONG + 2] = tz / slip


@inlined
def set_velocity(k, x, y, z, state, floats, ints):
    """Give body k a velocity; the kinetic energy that this takes is counted as dissipated."""
    at = ints[VELOCITY] + 3 * k
    before = state[at] ** 2 + state[at + 1] ** 2 + state[at + 2] ** 2
    after = x * x + y * y + z * z
    state[ints[WORK]] += 0.5 * floats[ints[MASS] + k] * (before - after)
    state[at], state[at + 1], state[at + 2] = x, y, z


@inlined
def note_instant(t, k, y, floats, ints):
    """Remember where body k is and how fast, at an accepted instant."""
    last = ints[LAST] + INSTANT * k
    floats[last] = t
    for c in range(3):
        floats[last + 1 + c] = y[ints[POSITION] + 3 * k + c]
        floats[last + 4 + c] = y[ints[VELOCITY] + 3 * k + c]


@inlined
def hold(t, y, floats, ints):
    """Keep what rests on its surface, let go what has left it, and note the accepted instant."""
    for k in range(ints[BODIES]):
        for j in range(ints[OBJECTS]):
            memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
            if floats[memory] == FREE:
                continue
            at = HEAD + OBJECT * j
            px, py, pz, vx, vy, vz = body_of(ints, k, y)
            ux, uy, uz = velocity(floats, ints, at, px, py, pz)
            d, nx, ny, nz = surface(floats, ints, at, px, py, pz)
            d -= floats[ints[RADIUS] + k] + floats[ints[THICKNESS]]
            rx, ry, rz = vx - ux, vy - uy, vz - uz
            vn = rx * nx + ry * ny + rz * nz
            small = 1e-12 * scale_of(px, py, pz)
            if d > small and vn > STILL and floats[memory + PRESS] >= 0.0:
                floats[memory] = FREE
                floats[1] = 1.0
                continue
            if floats[memory + PRESS] < 0.0 and (abs(d) > small or abs(vn) > small):
                to = ints[POSITION] + 3 * k
                y[to], y[to + 1], y[to + 2] = px - d * nx, py - d * ny, pz - d * nz
                set_velocity(k, vx - vn * nx, vy - vn * ny, vz - vn * nz, y, floats, ints)
                floats[1] = 1.0
            rx, ry, rz = rx - vn * nx, ry - vn * ny, rz - vn * nz
            if math.sqrt(rx * rx + ry * ry + rz * rz) > STILL:
                come_to_rest(memory, rx, ry, rz, nx, ny, nz, floats, ints)
        note_instant(t, k, y, floats, ints)


@kernel(IMPACT)
def impact(t, y, pair, floats, ints):
    """The impulse of a pair at its impact, or the end of its sliding; pair -1: `hold`."""
    if pair < 0:
        hold(t, y, floats, ints)
        return
    k, j = pair // ints[OBJECTS], pair % ints[OBJECTS]
    at = HEAD + OBJECT * j
    memory = ints[PAIRS] + PAIR * pair
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    vx, vy, vz = vx - ux, vy - uy, vz - uz
    vn = vx * nx + vy * ny + vz * nz
    press = floats[memory + PRESS]
    if floats[memory] == SLIDES:
        tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
        if tx * tx + ty * ty + tz * tz < 1e-12:
            set_velocity(k, ux + vn * nx, uy + vn * ny, uz + vn * nz, y, floats, ints)
            floats[memory] = STICKS
        else:
            come_to_rest(memory, vx, vy, vz, nx, ny, nz, floats, ints)
    elif vn < -STILL or (vn < 0.0 and press >= 0.0):
        e = floats[ints[RESTITUTION]]
        count_hit(floats, ints[TALLY], t, -vn)
        vx, vy, vz = bounce(vx, vy, vz, nx, ny, nz, e, floats[ints[FRICTION]])
        up = -e * vn
        if press < 0.0 and up * up < -2.0 * press * LOWEST_FLIGHT * scale_of(px, py, pz):
            vx, vy, vz = vx - up * nx, vy - up * ny, vz - up * nz
            come_to_rest(memory, vx, vy, vz, nx, ny, nz, floats, ints)
            # What is left of the bouncing is a geometric series of flights.
            floats[ints[TALLY] + REST_TIME] = t + (2.0 * up / (-press * (1.0 - e)) if e < 1.0 else 0.0)
        set_velocity(k, vx + ux, vy + uy, vz + uz, y, floats, ints)
    elif vn <= STILL and press < 0.0:
        vx, vy, vz = vx - vn * nx, vy - vn * ny, vz - vn * nz
        come_to_rest(memory, vx, vy, vz, nx, ny, nz, floats, ints)
        floats[ints[TALLY] + REST_TIME] = t
        set_velocity(k, vx + ux, vy + uy, vz + uz, y, floats, ints)
    note_instant(t, k, y, floats, ints)


@inlined
def pressing(k, j, y, rate, floats, ints):
    """Second derivative of the gap [m/s^2] and the normal (3) there."""
    at = HEAD + OBJECT * j
    to = ints[VELOCITY] + 3 * k
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
    ax, ay, az = acceleration(floats, ints, at, px, py, pz)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    press = (rate[to] - ax) * nx + (rate[to + 1] - ay) * ny + (rate[to + 2] - az) * nz
    return press + bend(floats, ints, at, px, py, pz, vx - ux, vy - uy, vz - uz), nx, ny, nz


@inlined
def press_of_pairs(k, y, rate, floats, ints):
    """Store how each near pair would press if nothing held it; the number of resting pairs."""
    resting = 0
    px, py, pz, _, _, _ = body_of(ints, k, y)
    reach = floats[ints[RADIUS] + k] + floats[ints[THICKNESS]]
    for j in range(ints[OBJECTS]):
        memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
        floats[memory + LOAD] = 0.0
        if floats[memory] != FREE:
            resting += 1
        elif surface(floats, ints, HEAD + OBJECT * j, px, py, pz)[0] - reach > NEAR * scale_of(px, py, pz):
            continue
        floats[memory + PRESS] = pressing(k, j, y, rate, floats, ints)[0]
    return resting


@inlined
def carry(k, resting, y, rate, floats, ints):
    """Normal forces, none negative, that leave no resting pair pressing: projected Gauss-Seidel over the pairs."""
    to = ints[VELOCITY] + 3 * k
    for _ in range(SWEEPS):
        change = 0.0
        for j in range(ints[OBJECTS]):
            memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
            if floats[memory] == FREE:
                continue
            press, nx, ny, nz = pressing(k, j, y, rate, floats, ints)
            load = max(0.0, floats[memory + LOAD] - press)
            add = load - floats[memory + LOAD]
            floats[memory + LOAD] = load
            rate[to] += add * nx
            rate[to + 1] += add * ny
            rate[to + 2] += add * nz
            change = max(change, abs(add))
        if resting == 1 or change < 1e-12:
            break


@inlined
def rub(k, y, rate, floats, ints):
    """Coulomb's friction of resting pairs: against the sliding, or up to its bound against what would start it."""
    mu = floats[ints[FRICTION]]
    to = ints[VELOCITY] + 3 * k
    for j in range(ints[OBJECTS]):
        memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
        most = mu * floats[memory + LOAD]
        if floats[memory] == FREE or most == 0.0:
            continue
        at = HEAD + OBJECT * j
        px, py, pz, vx, vy, vz = body_of(ints, k, y)
        ux, uy, uz = velocity(floats, ints, at, px, py, pz)
        vx, vy, vz = vx - ux, vy - uy, vz - uz
        _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
        vn = vx * nx + vy * ny + vz * nz
        dx, dy, dz = vx - vn * nx, vy - vn * ny, vz - vn * nz
        size = math.sqrt(dx * dx + dy * dy + dz * dz)
        if floats[memory] == SLIDES:
            ax, ay, az = floats[memory + ALONG], floats[memory + ALONG + 1], floats[memory + ALONG + 2]
            # Past the instant when it stops the force goes on, so that the stop is a clean root.
            if size < STILL:
                dx, dy, dz, size = ax, ay, az, 1.0
            elif dx * ax + dy * ay + dz * az < 0.0:
                size = -size
        elif size < STILL:
            ax, ay, az = acceleration(floats, ints, at, px, py, pz)
            dx, dy, dz = rate[to] - ax, rate[to + 1] - ay, rate[to + 2] - az
            an = dx * nx + dy * ny + dz * nz
            dx, dy, dz = dx - an * nx, dy - an * ny, dz - an * nz
            size = math.sqrt(dx * dx + dy * dy + dz * dz)
            most = min(most, size)
        if size == 0.0:
            continue
        dx, dy, dz = dx / size, dy / size, dz / size
        rate[to] -= most * dx
        rate[to + 1] -= most * dy
        rate[to + 2] -= most * dz
        rate[ints[WORK]] += floats[ints[MASS] + k] * most * (dx * vx + dy * vy + dz * vz)


@kernel(TERM)
def constrain(t, y, rate, floats, ints):
    """Take from the acceleration of bodies that rest what pushes into the surface, and add Coulomb's friction."""
    for k in range(ints[BODIES]):
        if floats[ints[INVERSE] + k] == 0.0:
            continue
        resting = press_of_pairs(k, y, rate, floats, ints)
        if resting > 0:
            carry(k, resting, y, rate, floats, ints)
            rub(k, y, rate, floats, ints)
