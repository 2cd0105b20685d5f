# mypy: ignore-errors
"""Masses that rest on each other in `exact` mode, at the ends of steps: kept in place, or released.

Compiled when two masses first come near each other (sphere_events_kernels).
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.impact_kernels import STILL
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import approach, distance, extent, of, radii
from sceneql.contacts.pair_kernels import NEAR
from sceneql.contacts.resting_kernels import CREEP
from sceneql.system.signatures_kernels import IMPACT

hit = lazy("sceneql.contacts.mutual.sphere_hit_kernels:hit", IMPACT)

SMALL = 1e-12
"""Gap, relative to the coordinates, and speed [m/s] that rounding may make."""
PULLED = 1e-9
"""Acceleration [m/s^2] above which a pair without a load is pulled apart."""


@inlined
def put_right(i, j, gap, speed, load, slow, y, floats, ints):
    """Close the gap of a pair under load, and end its normal velocity, ``speed``; where ``slow`` its slip, too.

    What this takes, and the work of the load on the gap, is booked half to each.
    """
    a, b = floats[of(ints, i, spheres.INVERSE)], floats[of(ints, j, spheres.INVERSE)]
    away = distance(i, j, y, ints)
    lost = load * gap if load > 0.0 else 0.0
    for c in range(3):
        at, to = of(ints, i, spheres.X) + c, of(ints, j, spheres.X) + c
        normal = (y[at] - y[to]) / away
        u, w = of(ints, i, spheres.V) + c, of(ints, j, spheres.V) + c
        ends = y[u] - y[w] if slow else speed * normal
        lost += ends * (y[u] - y[w] - 0.5 * ends) / (a + b)
        y[u] -= a / (a + b) * ends
        y[w] += b / (a + b) * ends
        if load > 0.0:
            y[at] -= a / (a + b) * gap * normal
            y[to] += b / (a + b) * gap * normal
    y[of(ints, i, spheres.WORK)] += 0.5 * lost
    y[of(ints, j, spheres.WORK)] += 0.5 * lost


@inlined
def slip_of(i, j, speed, y, ints):
    """Speed [m/s] of two masses across the line of their centers."""
    square = -speed * speed
    for c in range(3):
        square += (y[of(ints, i, spheres.V) + c] - y[of(ints, j, spheres.V) + c]) ** 2
    return math.sqrt(max(0.0, square))


@kernel(IMPACT, inner=True)
def hold(t, y, pair, floats, ints):
    """At the end of a step: keep resting pairs, release those that part; at the start, find those that rest."""
    first = math.isnan(floats[ints[spheres.POINTS]])
    friction = floats[ints[spheres.FRICTION]]
    other = -1
    for i in range(ints[spheres.COUNT]):
        small = SMALL * extent(i, y, ints)
        for j in range(i + 1, ints[spheres.COUNT]):
            other += 1
            memory = ints[spheres.PAIRS] + spheres.PAIR * other
            fixed = floats[of(ints, i, spheres.INVERSE)] + floats[of(ints, j, spheres.INVERSE)] == 0.0
            if fixed or (floats[memory + spheres.RESTS] == 0.0 and not first):
                continue
            gap = distance(i, j, y, ints) - radii(i, j, floats, ints)
            speed = -approach(i, j, y, ints)
            if first:
                floats[memory + spheres.RESTS] = 1.0 if abs(gap) <= small and abs(speed) <= STILL else 0.0
                continue
            load = floats[memory + spheres.LOAD]
            pulled = load == 0.0 and (floats[memory + spheres.PRESS] > PULLED or speed > STILL)
            if pulled or gap > NEAR * extent(i, y, ints):
                floats[memory + spheres.RESTS] = 0.0
            elif speed < -STILL:
                hit(t, y, other, floats, ints)
            else:
                slip = slip_of(i, j, speed, y, ints) if friction > 0.0 else 0.0
                slow = 0.0 < slip < CREEP and floats[memory + spheres.PULL] < friction * load
                if not (
                    slow or (load > 0.0 and abs(gap) > small) or (abs(speed) > small and (load > 0.0 or speed < 0.0))
                ):
                    continue
                put_right(i, j, gap, speed, load, slow, y, floats, ints)
            floats[channels.CHANGED] = 1.0
