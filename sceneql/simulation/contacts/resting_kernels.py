# mypy: ignore-errors
"""Resting contact: the normal force that carries a body, Coulomb's friction, and what keeps it on the surface.

The direction of Coulomb's friction turns at a rate of friction / speed: infinitely stiff as the speed goes to 0. So a
body slower than CREEP sticks: friction there goes against the pull, not against the velocity, and what velocity is
left is taken away once the pull is too weak. Only one that slides to its end, with little pull, stops by itself.
"""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
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
    STILL,
    TALLY,
    THICKNESS,
    VELOCITY,
    WORK,
    scale_of,
)
from sceneql.simulation.contacts.memory_kernels import (
    ALONG,
    CREEPS,
    EARLIER,
    FREE,
    LIST,
    LOAD,
    PAIR,
    PRESS,
    PULL,
    RESTING,
    SLIDES,
    STICKS,
    SUPPORT,
)
from sceneql.simulation.contacts.shape_kernels import FLAT, FOUR, OBJECT, acceleration, bend, facing, surface, velocity
from sceneql.system_kernels import A, F, I, N

NEAR = 1e-9
"""Distance, as a part of the coordinates, within which a free pair's normal acceleration is worth knowing."""

CREEP = 1e-3
"""Speed along the surface [m/s] below which friction goes against the pull."""

SWEEPS = 50


@lean_inlined
def body_of(ints, k, y):
    """Place of body k, its velocity, and its reach's offset parts."""
    at = ints[POSITION] + 3 * k
    to = ints[VELOCITY] + 3 * k
    return y[at], y[at + 1], y[at + 2], y[to], y[to + 1], y[to + 2]


@lean_inlined
def set_velocity(k, x, y, z, state, floats, ints):
    """Give body k a velocity; the kinetic energy that this takes is counted as dissipated."""
    at = ints[VELOCITY] + 3 * k
    before = state[at] ** 2 + state[at + 1] ** 2 + state[at + 2] ** 2
    after = x * x + y * y + z * z
    state[ints[WORK]] += 0.5 * floats[ints[MASS] + k] * (before - after)
    state[at], state[at + 1], state[at + 2] = x, y, z


@lean(types.void(F, N, F, F, F, F, F, F, A, I), inner=True)
def come_to_rest(t, memory, vx, vy, vz, nx, ny, nz, floats, ints):
    """Note that a pair rests from t on: sliding along v (relative to the surface), or sticking."""
    if math.isnan(floats[ints[TALLY] + REST_TIME]):
        floats[ints[TALLY] + REST_TIME] = t
    vn = vx * nx + vy * ny + vz * nz
    tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    slip = math.sqrt(tx * tx + ty * ty + tz * tz)
    slides = slip >= CREEP or floats[ints[FRICTION]] == 0.0
    floats[memory] = SLIDES if slides else STICKS
    floats[memory + EARLIER] = math.nan
    if slip > 0.0:
        floats[memory + ALONG] = tx / slip
        floats[memory + ALONG + 1] = ty / slip
        floats[memory + ALONG + 2] = tz / slip


@lean(types.boolean(F, N, N, A, A, I), inner=True)
def keep(t, k, j, y, floats, ints):
    """Hold a resting pair on its surface, or let it go when it has left: whether anything changed."""
    memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
    if floats[memory] == FREE:
        return False
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
        return True
    changed = floats[memory + PRESS] < 0.0 and (abs(d) > small or abs(vn) > small)
    if changed:
        to = ints[POSITION] + 3 * k
        y[to], y[to + 1], y[to + 2] = px - d * nx, py - d * ny, pz - d * nz
        # What presses does work on that way.
        y[ints[WORK]] -= floats[ints[MASS] + k] * floats[memory + PRESS] * d
        set_velocity(k, vx - vn * nx, vy - vn * ny, vz - vn * nz, y, floats, ints)
    if floats[memory] == CREEPS:
        return changed
    rx, ry, rz = rx - vn * nx, ry - vn * ny, rz - vn * nz
    slip = math.sqrt(rx * rx + ry * ry + rz * rz)
    most = floats[ints[FRICTION]] * floats[memory + LOAD]
    if slip >= CREEP or (floats[memory] == SLIDES and floats[memory + PULL] > 0.5 * most):
        come_to_rest(t, memory, rx, ry, rz, nx, ny, nz, floats, ints)
    elif floats[memory] == STICKS and floats[memory + PULL] <= most and slip > 0.0:
        set_velocity(k, vx - vn * nx - rx, vy - vn * ny - ry, vz - vn * nz - rz, y, floats, ints)
        changed = True
    return changed


@lean(FOUR(N, N, A, A, A, I), inner=True)
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


@lean_inlined
def away(k, j, y, floats, ints):
    """Whether a pair is too far apart for its normal acceleration to matter."""
    px, py, pz, _, _, _ = body_of(ints, k, y)
    gap = surface(floats, ints, HEAD + OBJECT * j, px, py, pz)[0] - floats[ints[RADIUS] + k] - floats[ints[THICKNESS]]
    return gap > NEAR * scale_of(px, py, pz)


@lean_inlined
def press_of_pairs(k, near, y, rate, floats, ints):
    """Store how each resting pair would press if nothing held it, and each free one if asked.

    The number of resting ones; of the last of these the memory and the normal (3).
    """
    resting, last = 0, 0
    nx, ny, nz = 0.0, 0.0, 0.0
    for j in range(ints[OBJECTS]):
        memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
        rests = floats[memory] != FREE
        if not rests and (not near or away(k, j, y, floats, ints)):
            continue
        press, ax, ay, az = pressing(k, j, y, rate, floats, ints)
        floats[memory + LOAD] = 0.0
        floats[memory + PRESS] = press
        if rests:
            resting += 1
            last, nx, ny, nz = memory, ax, ay, az
    return resting, last, nx, ny, nz


@lean_inlined
def bear(k, memory, nx, ny, nz, rate, floats, ints):
    """The normal force that leaves a single resting pair not pressing."""
    to = ints[VELOCITY] + 3 * k
    load = max(0.0, -floats[memory + PRESS])
    floats[memory + LOAD] = load
    rate[to] += load * nx
    rate[to + 1] += load * ny
    rate[to + 2] += load * nz


@lean_inlined
def carry(k, y, rate, floats, ints):
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
        if change < 1e-12:
            break


@lean_inlined
def rub(k, y, rate, floats, ints):
    """Coulomb's friction of resting pairs: against the sliding, or up to its bound against the pull."""
    mu = floats[ints[FRICTION]]
    to = ints[VELOCITY] + 3 * k
    for j in range(ints[OBJECTS]):
        memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
        most = mu * floats[memory + LOAD]
        if floats[memory] == FREE or floats[memory] == CREEPS:
            continue
        at = HEAD + OBJECT * j
        px, py, pz, vx, vy, vz = body_of(ints, k, y)
        ux, uy, uz = velocity(floats, ints, at, px, py, pz)
        vx, vy, vz = vx - ux, vy - uy, vz - uz
        ax, ay, az = acceleration(floats, ints, at, px, py, pz)
        _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
        dx, dy, dz = rate[to] - ax, rate[to + 1] - ay, rate[to + 2] - az
        dn = dx * nx + dy * ny + dz * nz
        dx, dy, dz = dx - dn * nx, dy - dn * ny, dz - dn * nz
        size = math.sqrt(dx * dx + dy * dy + dz * dz)
        floats[memory + PULL] = size
        if floats[memory] == STICKS:
            most = min(most, size)
        else:
            ax, ay, az = floats[memory + ALONG], floats[memory + ALONG + 1], floats[memory + ALONG + 2]
            vn = vx * nx + vy * ny + vz * nz
            dx, dy, dz = vx - vn * nx, vy - vn * ny, vz - vn * nz
            size = math.sqrt(dx * dx + dy * dy + dz * dz)
            # Past the instant when it stops the force goes on, so that the stop is a clean root.
            if size < STILL:
                dx, dy, dz, size = ax, ay, az, 1.0
            elif dx * ax + dy * ay + dz * az < 0.0:
                size = -size
        if size == 0.0:
            continue
        dx, dy, dz = dx / size, dy / size, dz / size
        rate[to] -= most * dx
        rate[to + 1] -= most * dy
        rate[to + 2] -= most * dz
        rate[ints[WORK]] += floats[ints[MASS] + k] * most * (dx * vx + dy * vy + dz * vz)


@lean_inlined
def is_flat(ints):
    """Whether a plane that never moves is all that the bodies can meet: then resting costs little."""
    return ints[OBJECTS] == 1 and ints[HEAD + FLAT] != 0


@lean_inlined
def lies(k, level, nx, ny, nz, y, floats, ints):
    """Whether body k lies on the plane n . x + level = 0 as it should, sticking or without friction.

    Then `keep` and `brake` would change nothing.
    """
    memory = ints[PAIRS] + PAIR * k
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    if floats[memory + PRESS] >= 0.0:
        return False
    if floats[memory] == STICKS:
        if vx != 0.0 or vy != 0.0 or vz != 0.0:
            return False
    elif floats[memory] != SLIDES or floats[ints[FRICTION]] != 0.0:
        return False
    d = level + (px * nx + py * ny + pz * nz) - floats[ints[RADIUS] + k] - floats[ints[THICKNESS]]
    small = 1e-12 * scale_of(px, py, pz)
    return abs(d) <= small and abs(vx * nx + vy * ny + vz * nz) <= small


@lean_inlined
def bear_lying(y, rate, floats, ints):
    """What `support` does, on a single plane that never moves."""
    _, nx, ny, nz = facing(floats, ints, HEAD, 0.0, 0.0, 0.0)
    resting_at = ints[LAST] + LIST
    for i in range(int(floats[ints[LAST] + RESTING])):
        k = int(floats[resting_at + i])
        memory, to = ints[PAIRS] + PAIR * k, ints[VELOCITY] + 3 * k
        if floats[memory] == FREE or floats[ints[INVERSE] + k] == 0.0:
            continue
        floats[memory + PRESS] = rate[to] * nx + rate[to + 1] * ny + rate[to + 2] * nz
        bear(k, memory, nx, ny, nz, rate, floats, ints)
        if floats[ints[FRICTION]] > 0.0:
            rub(k, y, rate, floats, ints)


@lean(SUPPORT, inner=True)
def support(near, y, rate, floats, ints):
    """Take from the acceleration of bodies that rest what pushes into the surface, and add Coulomb's friction.

    With ``near`` it is also noted how free pairs would press.
    """
    if not near and is_flat(ints):
        bear_lying(y, rate, floats, ints)
        return
    resting_at = ints[LAST] + LIST
    count = ints[BODIES] if near else int(floats[ints[LAST] + RESTING])
    for i in range(count):
        k = i if near else int(floats[resting_at + i])
        if floats[ints[INVERSE] + k] == 0.0:
            continue
        resting, memory, nx, ny, nz = press_of_pairs(k, near, y, rate, floats, ints)
        if resting > 1:
            carry(k, y, rate, floats, ints)
        elif resting == 1:
            bear(k, memory, nx, ny, nz, rate, floats, ints)
        if resting > 0 and floats[ints[FRICTION]] > 0.0:
            rub(k, y, rate, floats, ints)
