# mypy: ignore-errors
"""Coulomb friction of pairs that rest or slide, compiled where there is any."""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import STILL
from sceneql.contacts.pair_kernels import BRAKE, OF_BODY, body_of, tightness
from sceneql.contacts.resting_kernels import come_to_rest, set_velocity
from sceneql.contacts.shape_kernels import acceleration, surface, velocity
from sceneql.contacts.slide_kernels import tangential

FAST = 4.0
"""Slip, as a multiple of its largest change by friction in a step, above which its direction hardly changes."""


@lean_inlined
def hold_still(memory, vx, vy, vz, nx, ny, nz, dx, dy, dz, pull, to, rate, floats, ints):
    """Cancel a tangential acceleration d, and the rest of the slip of a velocity v relative to the surface."""
    if pull > 0.0:
        along = memory + layout.ALONG
        floats[along], floats[along + 1], floats[along + 2] = dx / pull, dy / pull, dz / pull
    vx, vy, vz = tangential(vx, vy, vz, nx, ny, nz)
    tight = tightness(floats, ints)
    rate[to] -= dx + tight * vx
    rate[to + 1] -= dy + tight * vy
    rate[to + 2] -= dz + tight * vz


@lean(OF_BODY, inner=True)
def rub(k, y, rate, floats, ints):
    """Coulomb friction of resting pairs: against the slip, or up to its bound against the tangential acceleration."""
    mu = floats[ints[layout.FRICTION]]
    to = ints[layout.VELOCITY] + 3 * k
    for j in range(ints[layout.OBJECTS]):
        memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
        most = mu * floats[memory + layout.LOAD]
        if floats[memory] == layout.FREE or floats[memory] == layout.CREEPS:
            continue
        at = layout.HEAD + layout.OBJECT * j
        px, py, pz, vx, vy, vz = body_of(ints, k, y)
        ux, uy, uz = velocity(floats, ints, at, px, py, pz)
        vx, vy, vz = vx - ux, vy - uy, vz - uz
        ax, ay, az = acceleration(floats, ints, at, px, py, pz)
        _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
        dx, dy, dz = rate[to] - ax, rate[to + 1] - ay, rate[to + 2] - az
        dn = dx * nx + dy * ny + dz * nz
        dx, dy, dz = dx - dn * nx, dy - dn * ny, dz - dn * nz
        size = math.sqrt(dx * dx + dy * dy + dz * dz)
        floats[memory + layout.PULL] = size
        if floats[memory] == layout.STICKS and floats[channels.STAGE] == channels.BETWEEN:
            # Hold up to the end of the step, where the pull is compared with friction's bound.
            hold_still(memory, vx, vy, vz, nx, ny, nz, dx, dy, dz, size, to, rate, floats, ints)
            continue
        if floats[memory] == layout.STICKS:
            most = min(most, size)
        else:
            slide = memory + layout.ALONG
            ax, ay, az = floats[slide], floats[slide + 1], floats[slide + 2]
            vn = vx * nx + vy * ny + vz * nz
            dx, dy, dz = vx - vn * nx, vy - vn * ny, vz - vn * nz
            size = math.sqrt(dx * dx + dy * dy + dz * dz)
            # The force continues past the stop, so that the slip has a simple root there.
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
        rate[ints[layout.WORK]] += floats[ints[layout.MASS] + k] * most * (dx * vx + dy * vy + dz * vz)


@lean(BRAKE, inner=True)
def brake(t, k, j, h, y0, y1, floats, ints):
    """Coulomb friction of a creeping pair, added after a step of length h without it: at most it stops the slip.

    It opposes the slip at the end: implicit, so no step is too long (Moreau 1988). The work of the pull on the distance
    taken back is counted. A pair that has become fast slides, one that has become slow creeps.
    """
    memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
    mu = floats[ints[layout.FRICTION]]
    if floats[memory] == layout.FREE or floats[memory] == layout.STICKS or mu == 0.0:
        return
    to, at = ints[layout.VELOCITY] + 3 * k, ints[layout.POSITION] + 3 * k
    x, y, z = y1[at], y1[at + 1], y1[at + 2]
    _, nx, ny, nz = surface(floats, ints, layout.HEAD + layout.OBJECT * j, x, y, z)
    ux, uy, uz = velocity(floats, ints, layout.HEAD + layout.OBJECT * j, x, y, z)
    vx, vy, vz = tangential(y1[to] - ux, y1[to + 1] - uy, y1[to + 2] - uz, nx, ny, nz)
    bx, by, bz = tangential(y0[to] - ux, y0[to + 1] - uy, y0[to + 2] - uz, nx, ny, nz)
    speed, before = math.sqrt(vx * vx + vy * vy + vz * vz), math.sqrt(bx * bx + by * by + bz * bz)
    most = mu * floats[memory + layout.LOAD] * h
    if floats[memory] == layout.SLIDES:
        if speed < FAST * most:
            floats[memory], floats[memory + layout.EARLIER] = layout.CREEPS, floats[memory + layout.LOAD]
        return
    if speed > 2.0 * FAST * most:
        come_to_rest(t, memory, vx, vy, vz, nx, ny, nz, floats, ints)
    if not math.isnan(floats[memory + layout.EARLIER]):
        most = 0.5 * (most + mu * floats[memory + layout.EARLIER] * h)
    floats[memory + layout.EARLIER] = floats[memory + layout.LOAD]
    back = 0.0
    if speed <= most:  # it stops, where a uniform deceleration of the slip from the start would have it stop
        cx, cy, cz = -vx, -vy, -vz
        if before > 0.0:
            bx, by, bz = bx / before, by / before, bz / before
            after = vx * bx + vy * by + vz * bz - most
            back = 0.5 * h * (after * after / (before - after) + after)
        floats[memory] = layout.STICKS
    else:
        part = most / speed
        cx, cy, cz = -part * vx, -part * vy, -part * vz
    sx, sy, sz = 0.5 * h * cx + back * bx, 0.5 * h * cy + back * by, 0.5 * h * cz + back * bz
    work = (y1[to] - y0[to]) * sx + (y1[to + 1] - y0[to + 1]) * sy + (y1[to + 2] - y0[to + 2]) * sz
    y1[ints[layout.WORK]] += floats[ints[layout.MASS] + k] * work / h
    y1[at], y1[at + 1], y1[at + 2] = x + sx, y + sy, z + sz
    set_velocity(k, y1[to] + cx, y1[to + 1] + cy, y1[to + 2] + cz, y1, floats, ints)
