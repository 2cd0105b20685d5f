# mypy: ignore-errors
"""Forces between masses that rest on each other in `exact` mode (sphere_events_kernels).

Nonnegative normal forces that leave no acceleration into each other, with Coulomb's friction, by projected Gauss-Seidel
sweeps over the contacts (Moreau 1988). Objects that these masses touch take part: they bear what is handed on to them.
"""

import math

import numpy as np

from sceneql.compiled.kernels import inlined, kernel
from sceneql.contacts import layout
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.simultaneous_kernels import NONE, PAIRS, ROWS
from sceneql.contacts.mutual.sphere_pair_kernels import distance, extent, of, pair_of, radii
from sceneql.contacts.pair_kernels import NEAR
from sceneql.contacts.resting_kernels import CREEP
from sceneql.contacts.shape_kernels import acceleration, bend, clear, surface, velocity
from sceneql.system.signatures_kernels import TERM, A, F, I, N

MOST_SWEEPS = 10000
EXACT = 1e-15
"""Change of an acceleration, relative to the largest, at which the forces are found."""

BEND, OFF, SLIP, FORCE, ROW = 3, 4, 7, 10, 13
"""A contact's row: its normal (3), the acceleration of its distance by the velocities [m/s^2], acceleration of the
object (3), direction of the slip (3; zero where it sticks), force on the first [N] (3)."""


@inlined
def relative(pairs, one, what, c, y, ints):
    """Component c of the place or velocity of a contact's first mass, relative to the second."""
    return y[of(ints, pairs[one, 0], what) + c] - y[of(ints, pairs[one, 1], what) + c]


@inlined
def describe(one, pairs, rows, y, floats, ints):
    """Write the row of a pair; the acceleration of its distance by the velocities is |slip|^2/distance."""
    away = distance(pairs[one, 0], pairs[one, 1], y, ints)
    speed, square = 0.0, 0.0
    for c in range(3):
        rows[one, c] = relative(pairs, one, spheres.X, c, y, ints) / away
        speed += relative(pairs, one, spheres.V, c, y, ints) * rows[one, c]
    for c in range(3):
        rows[one, SLIP + c] = relative(pairs, one, spheres.V, c, y, ints) - speed * rows[one, c]
        square += rows[one, SLIP + c] ** 2
    slip = math.sqrt(square)
    rows[one, BEND] = square / away
    for c in range(3):
        rows[one, SLIP + c] *= 1.0 / slip if slip >= CREEP else 0.0


@inlined
def find_objects(count, pairs, rows, y, floats, ints):
    """Add rows for the objects that the masses of the first ``count`` contacts touch; the number of all."""
    seen = np.zeros(ints[spheres.COUNT])
    total = count
    for end in range(2 * count):
        k = pairs[end // 2, end % 2]
        if seen[k] != 0.0 or floats[of(ints, k, spheres.INVERSE)] == 0.0:
            continue
        seen[k] = 1.0
        x, u = of(ints, k, spheres.X), of(ints, k, spheres.V)
        near = NEAR * extent(k, y, ints)
        reach = floats[of(ints, k, spheres.RADIUS)] + near
        for one in range(ints[spheres.OBJECTS]):
            at = spheres.HEAD + spheres.BODY * ints[spheres.COUNT] + layout.OBJECT * one
            if clear(floats, ints, at, y[x], y[x + 1], y[x + 2], reach):
                continue
            d, nx, ny, nz = surface(floats, ints, at, y[x], y[x + 1], y[x + 2])
            ux, uy, uz = velocity(floats, ints, at, y[x], y[x + 1], y[x + 2])
            vx, vy, vz = y[u] - ux, y[u + 1] - uy, y[u + 2] - uz
            if abs(d - reach + near) > near or abs(vx * nx + vy * ny + vz * nz) > CREEP:
                continue
            pairs[total, 0], pairs[total, 1] = k, NONE
            rows[total, 0], rows[total, 1], rows[total, 2] = nx, ny, nz
            rows[total, BEND] = bend(floats, ints, at, y[x], y[x + 1], y[x + 2], vx, vy, vz)
            ax, ay, az = acceleration(floats, ints, at, y[x], y[x + 1], y[x + 2])
            rows[total, OFF], rows[total, OFF + 1], rows[total, OFF + 2] = ax, ay, az
            total += 1
    return total


@kernel(F(N, F, PAIRS, ROWS, A, A, I), inner=True)
def settle(one, friction, pairs, rows, rate, floats, ints):
    """Change a contact's force so that its bodies do not accelerate into each other; the change of acceleration."""
    i, j = pairs[one, 0], pairs[one, 1]
    at = of(ints, i, spheres.V)
    to = at if j == NONE else of(ints, j, spheres.V)
    a = floats[of(ints, i, spheres.INVERSE)]
    b = 0.0 if j == NONE else floats[of(ints, j, spheres.INVERSE)]
    normal, along = rows[one, BEND], 0.0
    for c in range(3):
        normal += (rate[at + c] - (rows[one, OFF + c] if j == NONE else rate[to + c])) * rows[one, c]
        along += rows[one, FORCE + c] * rows[one, c]
    load = max(0.0, along - normal / (a + b))
    most, size = (0.0 if j == NONE else friction * load), 0.0
    tx, ty, tz = 0.0, 0.0, 0.0
    if most > 0.0:
        if rows[one, SLIP] != 0.0 or rows[one, SLIP + 1] != 0.0 or rows[one, SLIP + 2] != 0.0:
            tx, ty, tz = -rows[one, SLIP] * most, -rows[one, SLIP + 1] * most, -rows[one, SLIP + 2] * most
        else:
            across = normal - rows[one, BEND]
            tx = rows[one, FORCE] - along * rows[one, 0] - (rate[at] - rate[to] - across * rows[one, 0]) / (a + b)
            ty = (
                rows[one, FORCE + 1]
                - along * rows[one, 1]
                - (rate[at + 1] - rate[to + 1] - across * rows[one, 1]) / (a + b)
            )
            tz = (
                rows[one, FORCE + 2]
                - along * rows[one, 2]
                - (rate[at + 2] - rate[to + 2] - across * rows[one, 2]) / (a + b)
            )
            size = math.sqrt(tx * tx + ty * ty + tz * tz)
            part = most / size if size > most else 1.0
            tx, ty, tz = part * tx, part * ty, part * tz
    change = 0.0
    for c in range(3):
        force = load * rows[one, c] + (tx if c == 0 else (ty if c == 1 else tz))
        add = force - rows[one, FORCE + c]
        rows[one, FORCE + c] = force
        rate[at + c] += a * add
        if j != NONE:
            rate[to + c] -= b * add
        change = max(change, (a + b) * abs(add))
    return change


@inlined
def account(one, pairs, rows, y, rate, ints):
    """Book what a contact's force takes out, half to each of its masses."""
    i, j = pairs[one, 0], pairs[one, 1]
    for c in range(3):
        u = y[of(ints, i, spheres.V) + c] - (0.0 if j == NONE else y[of(ints, j, spheres.V) + c])
        rate[of(ints, i, spheres.WORK)] -= 0.5 * rows[one, FORCE + c] * u
        rate[of(ints, i if j == NONE else j, spheres.WORK)] -= 0.5 * rows[one, FORCE + c] * u


@inlined
def store(pairs, rows, y, rate, floats, ints):
    """Write the memory of the pairs that rest, and of those near touching."""
    one, pair = 0, 0
    for i in range(ints[spheres.COUNT]):
        near = NEAR * extent(i, y, ints)
        for j in range(i + 1, ints[spheres.COUNT]):
            memory = ints[spheres.PAIRS] + spheres.PAIR * pair
            pair += 1
            away = distance(i, j, y, ints)
            load, pull, normal, speed, square = 0.0, 0.0, 0.0, 0.0, 0.0
            if floats[memory + spheres.RESTS] == 0.0 and away >= radii(i, j, floats, ints) + near:
                continue
            for c in range(3):
                n = (y[of(ints, i, spheres.X) + c] - y[of(ints, j, spheres.X) + c]) / away
                v = y[of(ints, i, spheres.V) + c] - y[of(ints, j, spheres.V) + c]
                normal += (rate[of(ints, i, spheres.V) + c] - rate[of(ints, j, spheres.V) + c]) * n
                speed += v * n
                square += v * v
            if floats[memory + spheres.RESTS] != 0.0:
                for c in range(3):
                    load += rows[one, FORCE + c] * rows[one, c]
                    pull += rows[one, FORCE + c] ** 2
                one += 1
            floats[memory + spheres.LOAD], floats[memory + spheres.PULL] = load, math.sqrt(max(0.0, pull - load * load))
            floats[memory + spheres.PRESS] = normal + (square - speed * speed) / away


@kernel(TERM, inner=True)
def support(t, y, rate, floats, ints):
    """Add the forces between resting masses; store these, and the accelerations of distances of pairs near touching."""
    n = ints[spheres.COUNT]
    most = n * (n - 1) // 2
    pairs = np.empty((most + n * ints[spheres.OBJECTS], 2), dtype=np.int64)
    rows = np.zeros((pairs.shape[0], ROW))
    count, largest = 0, 0.0
    for pair in range(most):
        if floats[ints[spheres.PAIRS] + spheres.PAIR * pair + spheres.RESTS] != 0.0:
            i, j = pair_of(pair, ints)
            pairs[count, 0], pairs[count, 1] = i, j
            describe(count, pairs, rows, y, floats, ints)
            for c in range(3):
                largest = max(largest, abs(rate[of(ints, i, spheres.V) + c]), abs(rate[of(ints, j, spheres.V) + c]))
            largest = max(largest, rows[count, BEND])
            count += 1
    total = find_objects(count, pairs, rows, y, floats, ints)
    friction = floats[ints[spheres.FRICTION]]
    for _ in range(MOST_SWEEPS if total > 1 else min(total, 2)):
        change = 0.0
        for one in range(total):
            change = max(change, settle(one, friction, pairs, rows, rate, floats, ints))
        if change <= EXACT * largest:
            break
    for one in range(total):
        account(one, pairs, rows, y, rate, ints)
    store(pairs, rows, y, rate, floats, ints)
