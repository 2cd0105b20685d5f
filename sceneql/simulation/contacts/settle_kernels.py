# mypy: ignore-errors
"""Contacts in `local` mode: every body backs off to its own impacts within the step and flies the rest of it.

The body's path in the step is the cubic Hermite curve of its ends; after an impact it flies on with the step's mean
acceleration. An approach slower than what the pressing acceleration gives in two steps is no impact: the body rests
(resting_kernels), and slides for the rest of the step.
"""

import math

import numpy as np

from sceneql.kernels import inlined, kernel
from sceneql.simulation.contacts.impulse_kernels import (
    BODIES,
    FRICTION,
    HEAD,
    INVERSE,
    MASS,
    OBJECTS,
    PAIRS,
    POSITION,
    RADIUS,
    RESTITUTION,
    STILL,
    TALLY,
    THICKNESS,
    VELOCITY,
    WORK,
    bounce,
    count_hit,
)
from sceneql.simulation.contacts.path_kernels import NEVER, PATH, first_contact, moving, place
from sceneql.simulation.contacts.resting_kernels import (
    ALONG,
    FREE,
    PAIR,
    SLIDES,
    STICKS,
    come_to_rest,
    keep,
    set_velocity,
    support,
)
from sceneql.simulation.contacts.surface_kernels import MOVING, OBJECT, surface, velocity
from sceneql.system_kernels import SETTLE, TERM

MOST_IMPACTS = 8
"""Impacts of a body in one step; after that it is only kept outside."""


@inlined
def shift(path, ux, uy, uz, h):
    """Add a constant velocity to the path, about its end."""
    if ux != 0.0 or uy != 0.0 or uz != 0.0:
        path[0] -= ux * h
        path[1] -= uy * h
        path[2] -= uz * h
        path[3] += ux
        path[4] += uy
        path[5] += uz
        path[9] += ux
        path[10] += uy
        path[11] += uz


@inlined
def earliest(k, reach, path, floats, ints):
    """The first contact on the path with an object that the body does not rest on: (s, the object).

    The path is seen from the object as it moves.
    """
    best = NEVER
    first = 0
    h = path[12]
    for j in range(ints[OBJECTS]):
        if floats[ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)] != FREE:
            continue
        at = HEAD + OBJECT * j
        ux, uy, uz = velocity(floats, ints, at, path[0], path[1], path[2])
        shift(path, -ux, -uy, -uz, h)
        s = first_contact(path, floats, ints, at, reach)
        shift(path, ux, uy, uz, h)
        if s < best:
            best, first = s, j
    return best, first


@inlined
def start_with(path, x, y, z):
    """Start with another velocity; the kinetic energy by mass that this takes."""
    before = path[3] ** 2 + path[4] ** 2 + path[5] ** 2
    path[3], path[4], path[5] = x, y, z
    return 0.5 * (before - x * x - y * y - z * z)


@inlined
def fly_on(path, ax, ay, az, h):
    """End the path after a time h of constant acceleration."""
    path[6] = path[0] + h * (path[3] + 0.5 * h * ax)
    path[7] = path[1] + h * (path[4] + 0.5 * h * ay)
    path[8] = path[2] + h * (path[5] + 0.5 * h * az)
    path[9] = path[3] + h * ax
    path[10] = path[4] + h * ay
    path[11] = path[5] + h * az


@inlined
def along(ax, ay, az, vx, vy, vz, speed):
    """The acceleration's component along the velocity."""
    return (ax * vx + ay * vy + az * vz) / speed if speed > 0.0 else math.sqrt(ax * ax + ay * ay + az * az)


@inlined
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


@inlined
def fly(k, t1, reach, path, mean, floats, ints):
    """Take the path through its impacts; the energy by mass that they take [J/kg]."""
    whole = path[12]
    lost = 0.0
    for _ in range(MOST_IMPACTS):
        s, j = earliest(k, reach, path, floats, ints)
        if s == NEVER:
            break
        at = HEAD + OBJECT * j
        px, py, pz = place(path, s)
        vx, vy, vz = moving(path, s)
        d, nx, ny, nz = surface(floats, ints, at, px, py, pz)
        # Onto the surface: a root is found to rounding, a body may start a little inside.
        d = min(0.0, d - reach)
        path[0], path[1], path[2] = px - d * nx, py - d * ny, pz - d * nz
        ux, uy, uz = velocity(floats, ints, at, px, py, pz)
        rx, ry, rz = vx - ux, vy - uy, vz - uz
        vn = rx * nx + ry * ny + rz * nz
        press = min(0.0, mean[0] * nx + mean[1] * ny + mean[2] * nz)
        t = t1 - path[12] * (1.0 - s)
        path[12] *= 1.0 - s
        path[3], path[4], path[5] = vx, vy, vz
        if vn < 2.0 * press * whole:
            rx, ry, rz = bounce(rx, ry, rz, nx, ny, nz, floats[ints[RESTITUTION]], floats[ints[FRICTION]])
            lost += start_with(path, rx + ux, ry + uy, rz + uz)
            count_hit(floats, ints[TALLY], t, -vn)
            fly_on(path, mean[0], mean[1], mean[2], path[12])
        else:
            rx, ry, rz = rx - vn * nx, ry - vn * ny, rz - vn * nz
            lost += start_with(path, rx + ux, ry + uy, rz + uz)
            lost += slide(path, mean, nx, ny, nz, ux, uy, uz, press, floats[ints[FRICTION]])
            memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
            rx, ry, rz = path[9] - ux, path[10] - uy, path[11] - uz
            come_to_rest(t, memory, rx, ry, rz, nx, ny, nz, floats, ints)
        if path[12] <= 1e-14 * whole:
            break
    return lost


@inlined
def push_out(reach, path, floats, ints):
    """Put the path's end outside of all objects; the kinetic energy by mass of the approach that this takes."""
    before = path[9] ** 2 + path[10] ** 2 + path[11] ** 2
    for _ in range(3):
        clear = True
        for j in range(ints[OBJECTS]):
            at = HEAD + OBJECT * j
            d, nx, ny, nz = surface(floats, ints, at, path[6], path[7], path[8])
            d -= reach
            if d >= 0.0:
                continue
            clear = False
            path[6], path[7], path[8] = path[6] - d * nx, path[7] - d * ny, path[8] - d * nz
            ux, uy, uz = velocity(floats, ints, at, path[6], path[7], path[8])
            vn = (path[9] - ux) * nx + (path[10] - uy) * ny + (path[11] - uz) * nz
            if vn < 0.0:
                path[9], path[10], path[11] = path[9] - vn * nx, path[10] - vn * ny, path[11] - vn * nz
        if clear:
            break
    return 0.5 * (before - path[9] ** 2 - path[10] ** 2 - path[11] ** 2)


@inlined
def stop(k, j, h, y0, y1, floats, ints):
    """End the sliding of a pair whose friction has turned it round within the step of length h."""
    memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
    if floats[memory] != SLIDES or floats[ints[FRICTION]] == 0.0:
        return
    to, x = ints[VELOCITY] + 3 * k, ints[POSITION] + 3 * k
    ux, uy, uz = velocity(floats, ints, HEAD + OBJECT * j, y1[x], y1[x + 1], y1[x + 2])
    ax, ay, az = floats[memory + ALONG], floats[memory + ALONG + 1], floats[memory + ALONG + 2]
    before = (y0[to] - ux) * ax + (y0[to + 1] - uy) * ay + (y0[to + 2] - uz) * az
    after = (y1[to] - ux) * ax + (y1[to + 1] - uy) * ay + (y1[to + 2] - uz) * az
    if after >= 0.0:
        return
    # It came back from where it stopped with the same deceleration.
    back = 0.5 * after * after * h / max(before - after, -after)
    y1[x], y1[x + 1], y1[x + 2] = y1[x] + back * ax, y1[x + 1] + back * ay, y1[x + 2] + back * az
    set_velocity(k, ux, uy, uz, y1, floats, ints)
    floats[memory] = STICKS


@inlined
def far(k, h, reach, y0, y1, floats, ints):
    """Whether a body is surely too far from all objects to touch one in the step: then it costs next to nothing."""
    at, to = ints[POSITION] + 3 * k, ints[VELOCITY] + 3 * k
    way = 0.0
    for c in range(3):
        # The largest component of the Bezier coefficients of the path's velocity.
        middle = 3.0 * (y1[at + c] - y0[at + c]) / h - y0[to + c] - y1[to + c]
        way += max(abs(middle), max(abs(y0[to + c]), abs(y1[to + c])))
    way *= h
    for j in range(ints[OBJECTS]):
        pair = k * ints[OBJECTS] + j
        if floats[ints[PAIRS] + PAIR * pair] != FREE or ints[HEAD + OBJECT * j + MOVING] != 0:
            return False
        if surface(floats, ints, HEAD + OBJECT * j, y1[at], y1[at + 1], y1[at + 2])[0] - reach <= way:
            return False
    return True


@kernel(SETTLE)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Change y1 so that no body went through a surface in the step from t0 to t1."""
    path = np.empty(PATH)
    mean = np.empty(3)
    for k in range(ints[BODIES]):
        if floats[ints[INVERSE] + k] == 0.0:
            continue
        reach = floats[ints[RADIUS] + k] + floats[ints[THICKNESS]]
        if far(k, t1 - t0, reach, y0, y1, floats, ints):
            continue
        for j in range(ints[OBJECTS]):
            stop(k, j, t1 - t0, y0, y1, floats, ints)
            keep(t1, k, j, y1, floats, ints)
        at, to = ints[POSITION] + 3 * k, ints[VELOCITY] + 3 * k
        for c in range(3):
            path[c], path[3 + c] = y0[at + c], y0[to + c]
            path[6 + c], path[9 + c] = y1[at + c], y1[to + c]
            mean[c] = (y1[to + c] - y0[to + c]) / (t1 - t0)
        path[12] = t1 - t0
        lost = fly(k, t1, reach, path, mean, floats, ints)
        lost += push_out(reach, path, floats, ints)
        y1[ints[WORK]] += floats[ints[MASS] + k] * lost
        for c in range(3):
            y1[at + c], y1[to + c] = path[6 + c], path[9 + c]


@kernel(TERM)
def constrain(t, y, rate, floats, ints):
    """What the surfaces do to the accelerations; free pairs cost nothing."""
    support(False, y, rate, floats, ints)
