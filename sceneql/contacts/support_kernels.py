# mypy: ignore-errors
"""Normal forces on bodies that rest, and Coulomb friction: compiled when the first body rests."""

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import STILL
from sceneql.contacts.pair_kernels import OF_BODY, OF_PAIR, SUPPORT, away, body_of, is_flat
from sceneql.contacts.pressing_kernels import pressing
from sceneql.contacts.shape_kernels import facing, surface, velocity

rub = lazy("sceneql.contacts.friction_kernels:rub", OF_BODY)
carry = lazy("sceneql.contacts.carry_kernels:carry", OF_BODY)
tie = lazy("sceneql.contacts.resting_ties_kernels:tie", OF_BODY)
tie_one = lazy("sceneql.contacts.resting_ties_kernels:tie_one", OF_PAIR)


@lean_inlined
def press_of_pairs(k, near, y, rate, floats, ints):
    """Store the free normal acceleration of each resting pair of body k, and of free ones where ``near``.

    Returns the number of resting pairs; memory and normal (3) of the last of them.
    """
    resting, last = 0, 0
    nx, ny, nz = 0.0, 0.0, 0.0
    for j in range(ints[layout.OBJECTS]):
        memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
        rests = floats[memory] != layout.FREE
        if not rests and (not near or away(k, j, y, floats, ints)):
            continue
        press, ax, ay, az = pressing(k, j, y, rate, floats, ints)
        floats[memory + layout.LOAD] = 0.0
        floats[memory + layout.PRESS] = press
        if rests:
            resting += 1
            last, nx, ny, nz = memory, ax, ay, az
    return resting, last, nx, ny, nz


@lean_inlined
def bear(k, memory, nx, ny, nz, rate, floats, ints):
    """The normal force that cancels the acceleration of a single resting pair into its surface."""
    to = ints[layout.VELOCITY] + 3 * k
    load = max(0.0, -floats[memory + layout.PRESS])
    floats[memory + layout.LOAD] = load
    rate[to] += load * nx
    rate[to + 1] += load * ny
    rate[to + 2] += load * nz


@lean_inlined
def book(k, memory, nx, ny, nz, y, rate, floats, ints):
    """Book the power of a pair's load where its body moves along the normal: other masses may push it in a step."""
    j = (memory - ints[layout.PAIRS]) // layout.PAIR - k * ints[layout.OBJECTS]
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
    speed = (vx - ux) * nx + (vy - uy) * ny + (vz - uz) * nz
    if abs(speed) > STILL:
        rate[ints[layout.WORK]] -= floats[ints[layout.MASS] + k] * floats[memory + layout.LOAD] * speed


@lean_inlined
def book_all(k, y, rate, floats, ints):
    """`book` for a body that rests on several objects."""
    px, py, pz, _, _, _ = body_of(ints, k, y)
    for j in range(ints[layout.OBJECTS]):
        memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
        if floats[memory] != layout.FREE and floats[memory + layout.LOAD] > 0.0:
            _, nx, ny, nz = surface(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
            book(k, memory, nx, ny, nz, y, rate, floats, ints)


@lean_inlined
def bear_lying(y, rate, floats, ints):
    """As `support`, on a single plane that never moves."""
    _, nx, ny, nz = facing(floats, ints, layout.HEAD, 0.0, 0.0, 0.0)
    resting_at = ints[layout.LAST] + layout.LIST
    for i in range(int(floats[ints[layout.LAST] + layout.RESTING])):
        k = int(floats[resting_at + i])
        memory, to = ints[layout.PAIRS] + layout.PAIR * k, ints[layout.VELOCITY] + 3 * k
        if floats[memory] == layout.FREE or floats[ints[layout.INVERSE] + k] == 0.0:
            continue
        floats[memory + layout.PRESS] = rate[to] * nx + rate[to + 1] * ny + rate[to + 2] * nz
        bear(k, memory, nx, ny, nz, rate, floats, ints)
        book(k, memory, nx, ny, nz, y, rate, floats, ints)
        if floats[ints[layout.FRICTION]] > 0.0:
            rub(k, y, rate, floats, ints)


@lean(SUPPORT, inner=True)
def support(first, y, rate, floats, ints):
    """Remove the accelerations of resting bodies into their surfaces, and add Coulomb friction.

    With ``first`` at least 0 it starts with that body, and stores the normal accelerations of free pairs, too.
    """
    near = first >= 0
    ties = floats[channels.STAGE] == channels.BETWEEN
    if not near and not ties and is_flat(ints):
        bear_lying(y, rate, floats, ints)
        return
    resting_at = ints[layout.LAST] + layout.LIST
    count = ints[layout.BODIES] if near else int(floats[ints[layout.LAST] + layout.RESTING])
    for i in range(max(first, 0), count):
        k = i if near else int(floats[resting_at + i])
        if floats[ints[layout.INVERSE] + k] == 0.0:
            continue
        resting, memory, nx, ny, nz = press_of_pairs(k, near, y, rate, floats, ints)
        if resting > 1 and ties:
            tie(k, y, rate, floats, ints)
        elif resting == 1 and ties:
            tie_one(k, memory, nx, ny, nz, y, rate, floats, ints)
        elif resting > 1:
            carry(k, y, rate, floats, ints)
            book_all(k, y, rate, floats, ints)
        elif resting == 1:
            bear(k, memory, nx, ny, nz, rate, floats, ints)
            book(k, memory, nx, ny, nz, y, rate, floats, ints)
        if resting > 0 and floats[ints[layout.FRICTION]] > 0.0:
            rub(k, y, rate, floats, ints)
