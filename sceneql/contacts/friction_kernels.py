# mypy: ignore-errors
"""Coulomb's friction of pairs that rest or slide, compiled where there is any."""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.impulse_kernels import (
    FRICTION,
    HEAD,
    MASS,
    OBJECTS,
    PAIRS,
    POSITION,
    STILL,
    VELOCITY,
    WORK,
)
from sceneql.contacts.memory_kernels import (
    ALONG,
    BRAKE,
    CREEPS,
    EARLIER,
    FREE,
    LOAD,
    OF_BODY,
    PAIR,
    PULL,
    SLIDES,
    STICKS,
    tightness,
)
from sceneql.contacts.pair_kernels import body_of
from sceneql.contacts.resting_kernels import come_to_rest, set_velocity
from sceneql.contacts.shape_kernels import OBJECT, acceleration, surface, velocity
from sceneql.contacts.slide_kernels import tangential

FAST = 4.0
"""Slip, as a multiple of what friction can take from it in a step, above which its direction hardly turns."""


@lean_inlined
def hold_still(memory, vx, vy, vz, nx, ny, nz, dx, dy, dz, pull, to, rate, floats, ints):
    """Take away all of a pull d along the surface, and what slip is left of a velocity v relative to it."""
    if pull > 0.0:
        floats[memory + ALONG], floats[memory + ALONG + 1], floats[memory + ALONG + 2] = dx / pull, dy / pull, dz / pull
    vx, vy, vz = tangential(vx, vy, vz, nx, ny, nz)
    tight = tightness(floats, ints)
    rate[to] -= dx + tight * vx
    rate[to + 1] -= dy + tight * vy
    rate[to + 2] -= dz + tight * vz


@lean(OF_BODY, inner=True)
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
        if floats[memory] == STICKS and floats[channels.STAGE] == channels.BETWEEN:
            # To the end of the step, which sees whether the pull was too much.
            hold_still(memory, vx, vy, vz, nx, ny, nz, dx, dy, dz, size, to, rate, floats, ints)
            continue
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


@lean(BRAKE, inner=True)
def brake(t, k, j, h, y0, y1, floats, ints):
    """Coulomb's friction of a creeping pair in the step of length h, which was made without: at most it stops the slip.

    It goes against the slip at the end: implicit, so no step is too long (Moreau 1988). The way that it takes back does
    work for what pulls. A pair that has become fast slides, one that has become slow creeps.
    """
    memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
    mu = floats[ints[FRICTION]]
    if floats[memory] == FREE or floats[memory] == STICKS or mu == 0.0:
        return
    to, at = ints[VELOCITY] + 3 * k, ints[POSITION] + 3 * k
    x, y, z = y1[at], y1[at + 1], y1[at + 2]
    _, nx, ny, nz = surface(floats, ints, HEAD + OBJECT * j, x, y, z)
    ux, uy, uz = velocity(floats, ints, HEAD + OBJECT * j, x, y, z)
    vx, vy, vz = tangential(y1[to] - ux, y1[to + 1] - uy, y1[to + 2] - uz, nx, ny, nz)
    bx, by, bz = tangential(y0[to] - ux, y0[to + 1] - uy, y0[to + 2] - uz, nx, ny, nz)
    speed, before = math.sqrt(vx * vx + vy * vy + vz * vz), math.sqrt(bx * bx + by * by + bz * bz)
    most = mu * floats[memory + LOAD] * h
    if floats[memory] == SLIDES:
        if speed < FAST * most:
            floats[memory], floats[memory + EARLIER] = CREEPS, floats[memory + LOAD]
        return
    if speed > 2.0 * FAST * most:
        come_to_rest(t, memory, vx, vy, vz, nx, ny, nz, floats, ints)
    if not math.isnan(floats[memory + EARLIER]):
        most = 0.5 * (most + mu * floats[memory + EARLIER] * h)
    floats[memory + EARLIER] = floats[memory + LOAD]
    back = 0.0
    if speed <= most:  # it stops: where the slip from the start would, slowed down evenly
        cx, cy, cz = -vx, -vy, -vz
        if before > 0.0:
            bx, by, bz = bx / before, by / before, bz / before
            after = vx * bx + vy * by + vz * bz - most
            back = 0.5 * h * (after * after / (before - after) + after)
        floats[memory] = STICKS
    else:
        part = most / speed
        cx, cy, cz = -part * vx, -part * vy, -part * vz
    sx, sy, sz = 0.5 * h * cx + back * bx, 0.5 * h * cy + back * by, 0.5 * h * cz + back * bz
    work = (y1[to] - y0[to]) * sx + (y1[to + 1] - y0[to + 1]) * sy + (y1[to + 2] - y0[to + 2]) * sz
    y1[ints[WORK]] += floats[ints[MASS] + k] * work / h
    y1[at], y1[at + 1], y1[at + 2] = x + sx, y + sy, z + sz
    set_velocity(k, y1[to] + cx, y1[to + 1] + cy, y1[to + 2] + cz, y1, floats, ints)
