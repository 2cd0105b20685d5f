# mypy: ignore-errors
"""How a body slides in `local` mode: in the rest of a step after an impact, and in whole steps."""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.contacts.impulse_kernels import (
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
from sceneql.simulation.contacts.memory_kernels import CREEPS, EARLIER, FREE, LOAD, PAIR, SLIDES, STICKS
from sceneql.simulation.contacts.resting_kernels import come_to_rest, set_velocity
from sceneql.simulation.contacts.shape_kernels import OBJECT, surface, velocity
from sceneql.system_kernels import A, F, I, N

FAST = 4.0
"""Slip, as a multiple of what friction can take from it in a step, above which its direction hardly turns."""


@lean_inlined
def start_with(path, x, y, z):
    """Start with another velocity; the kinetic energy by mass that this takes."""
    before = path[3] ** 2 + path[4] ** 2 + path[5] ** 2
    path[3], path[4], path[5] = x, y, z
    return 0.5 * (before - x * x - y * y - z * z)


@lean_inlined
def fly_on(path, ax, ay, az, h):
    """End the path after a time h of constant acceleration."""
    path[6] = path[0] + h * (path[3] + 0.5 * h * ax)
    path[7] = path[1] + h * (path[4] + 0.5 * h * ay)
    path[8] = path[2] + h * (path[5] + 0.5 * h * az)
    path[9] = path[3] + h * ax
    path[10] = path[4] + h * ay
    path[11] = path[5] + h * az


@lean_inlined
def along(ax, ay, az, vx, vy, vz, speed):
    """The acceleration's component along the velocity."""
    return (ax * vx + ay * vy + az * vz) / speed if speed > 0.0 else math.sqrt(ax * ax + ay * ay + az * az)


@lean_inlined
def tangential(x, y, z, nx, ny, nz):
    """A vector without its part along the unit normal n."""
    part = x * nx + y * ny + z * nz
    return x - part * nx, y - part * ny, z - part * nz


@lean(F(A, A, F, F, F, F, F, F, F, F), inner=True)
def slide(path, mean, nx, ny, nz, ux, uy, uz, press, friction):
    """The rest of the path along the surface, with Coulomb's friction; its work by mass [J/kg]."""
    normal = mean[0] * nx + mean[1] * ny + mean[2] * nz
    away = max(0.0, normal)
    ax, ay, az = mean[0] - normal * nx, mean[1] - normal * ny, mean[2] - normal * nz
    vx, vy, vz = path[3] - ux, path[4] - uy, path[5] - uz
    most = -friction * press
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    pull = math.sqrt(ax * ax + ay * ay + az * az)
    h = path[12]
    sliding = h
    if speed < STILL and pull <= most:
        sliding = 0.0
    else:
        dx, dy, dz, size = (vx, vy, vz, speed) if speed >= STILL else (ax, ay, az, pull)
        if size > 0.0:
            drag = most / size
            ax, ay, az = ax - drag * dx, ay - drag * dy, az - drag * dz
            slowing = -(ax * dx + ay * dy + az * dz) / size
            if most > 0.0 and slowing * h > speed:
                sliding = speed / slowing
    lost = 0.0
    if sliding > 0.0:
        fly_on(path, ax, ay, az, sliding)
        lost = most * sliding * (speed + 0.5 * sliding * along(ax, ay, az, vx, vy, vz, speed))
    else:
        path[6], path[7], path[8] = path[0], path[1], path[2]
    if sliding < h:
        path[9], path[10], path[11] = ux, uy, uz
        path[6] += (h - sliding) * ux
        path[7] += (h - sliding) * uy
        path[8] += (h - sliding) * uz
    path[6] += 0.5 * h * h * away * nx
    path[7] += 0.5 * h * h * away * ny
    path[8] += 0.5 * h * h * away * nz
    path[9] += h * away * nx
    path[10] += h * away * ny
    path[11] += h * away * nz
    return lost


@lean(types.void(F, N, N, F, A, A, A, I), inner=True)
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
