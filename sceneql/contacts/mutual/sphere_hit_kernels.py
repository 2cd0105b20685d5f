# mypy: ignore-errors
"""Impacts of masses in `exact` mode, compiled at the first impact (sphere_events_kernels)."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.contacts.hit_kernels import LOWEST_FLIGHT
from sceneql.contacts.impact_kernels import STILL, count_hit
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.simultaneous_kernels import collide_at_once, parting, push
from sceneql.contacts.mutual.sphere_pair_kernels import ROWS, approach, distance, extent, of, pair_of, radii
from sceneql.system.signatures_kernels import IMPACT, A, I, N

AT_ONCE = 1e-11
"""Gap, relative to the coordinates, up to which a pair takes part in an impact of others."""


@kernel(types.int64[::1](N, A, A, I), inner=True)
def touching(pair, y, floats, ints):
    """The pairs that touch, ``pair`` first."""
    n = ints[spheres.COUNT]
    found, count, other = np.empty(n * (n - 1) // 2, dtype=np.int64), 1, 0
    found[0] = pair
    for i in range(n):
        near = AT_ONCE * extent(i, y, ints)
        for j in range(i + 1, n):
            fixed = floats[of(ints, i, spheres.INVERSE)] + floats[of(ints, j, spheres.INVERSE)] == 0.0
            calm = floats[ints[spheres.PAIRS] + spheres.PAIR * other + spheres.RESTS] != 0.0
            close = calm or distance(i, j, y, ints) < radii(i, j, floats, ints) + near
            if other != pair and not fixed and close:
                found[count] = other
                count += 1
            other += 1
    return found[:count]


@kernel(types.void(types.int64[::1], types.int64[:, ::1], ROWS, A, ROWS, A, A, I), inner=True)
def lay_out(found, pairs, normals, inverse, v, y, floats, ints):
    """Write the contacts of simultaneous_kernels for these pairs: masses, normals, inverse masses, velocities."""
    for one in range(found.size):
        i, j = pair_of(found[one], ints)
        pairs[one, 0], pairs[one, 1] = i, j
        away = distance(i, j, y, ints)
        for c in range(3):
            normals[one, c] = (y[of(ints, i, spheres.X) + c] - y[of(ints, j, spheres.X) + c]) / away
    for k in range(inverse.size):
        inverse[k] = floats[of(ints, k, spheres.INVERSE)]
        for c in range(3):
            v[k, c] = y[of(ints, k, spheres.V) + c]


@inlined
def rests(one, found, pairs, normals, v, y, floats, ints):
    """Whether a pair neither approaches nor parts, or parts for a flight that rounding hides."""
    speed = parting(one, pairs, normals, v)
    press = floats[ints[spheres.PAIRS] + spheres.PAIR * found[one] + spheres.PRESS]
    flight = 0.0 < speed and speed * speed < -2.0 * press * LOWEST_FLIGHT * extent(pairs[one, 0], y, ints)
    return abs(speed) <= STILL or flight


@kernel(IMPACT, inner=True)
def hit(t, y, pair, floats, ints):
    """The impulses of a pair that approaches, and of all that touch."""
    i, j = pair_of(pair, ints)
    speed = approach(i, j, y, ints)
    found = touching(pair, y, floats, ints)
    if speed < -STILL:
        found = found[:1]  # it only leaves: for a flight, or to rest if that is hidden
    n, count = ints[spheres.COUNT], found.size
    pairs, normals, lost = np.empty((count, 2), dtype=np.int64), np.empty((count, 3)), np.zeros(count)
    inverse, v = np.empty(n), np.empty((n, 3))
    lay_out(found, pairs, normals, inverse, v, y, floats, ints)
    if speed > STILL:
        e, friction = floats[ints[spheres.RESTITUTION]], floats[ints[spheres.FRICTION]]
        for _ in range(collide_at_once(pairs, normals, inverse, e, friction, STILL, v, lost)):
            count_hit(floats, ints[spheres.TALLY], t, speed)
    for one in range(count):
        calm = rests(one, found, pairs, normals, v, y, floats, ints)
        floats[ints[spheres.PAIRS] + spheres.PAIR * found[one] + spheres.RESTS] = 1.0 if calm else 0.0
        if calm:
            apart = parting(one, pairs, normals, v)
            if apart > STILL:
                p = -apart / (inverse[pairs[one, 0]] + inverse[pairs[one, 1]])
                push(one, p, pairs, normals, inverse, v)
                lost[one] -= 0.5 * p * apart
        for end in range(2):
            y[of(ints, pairs[one, end], spheres.WORK)] += 0.5 * lost[one]
    for k in range(n):
        for c in range(3):
            y[of(ints, k, spheres.V) + c] = v[k, c]
