# mypy: ignore-errors
"""The normal force that carries bodies that rest, and Coulomb's friction: compiled when the first body needs them."""

import math

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
    STILL,
    VELOCITY,
    WORK,
)
from sceneql.simulation.contacts.memory_kernels import (
    ALONG,
    CREEPS,
    FREE,
    LIST,
    LOAD,
    PAIR,
    PRESS,
    PULL,
    RESTING,
    STICKS,
    SUPPORT,
)
from sceneql.simulation.contacts.pair_kernels import away, body_of, is_flat
from sceneql.simulation.contacts.shape_kernels import FOUR, OBJECT, acceleration, bend, facing, surface, velocity
from sceneql.system_kernels import A, I, N

SWEEPS = 50


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
def support(first, y, rate, floats, ints):
    """Take from the acceleration of bodies that rest what pushes into the surface, and add Coulomb's friction.

    With ``first`` at least 0, bodies from that one on are looked at, and it is also noted how free pairs would press.
    """
    near = first >= 0
    if not near and is_flat(ints):
        bear_lying(y, rate, floats, ints)
        return
    resting_at = ints[LAST] + LIST
    count = ints[BODIES] if near else int(floats[ints[LAST] + RESTING])
    for i in range(max(first, 0), count):
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
