# mypy: ignore-errors
"""Masses that rest on one another and on objects: impulses at the end of a step, and removal of overlaps.

Nonnegative normal impulses with Coulomb friction, iterated over the contacts until none approaches (projected
Gauss-Seidel; Moreau 1988). A mass is moved by half the step times its change of velocity, as if the contact force had
acted during the step: so resting masses stay in place, and the work of gravity on that distance is no loss. The sweeps
begin with the impulses of the step before (sphere_warm_kernels). What is near masses that touch takes part, so that
none is pushed into it: contacts across a gap may close it, but not go on.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.contacts import layout
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import PAIR_ROWS, ROWS, approach, distance, of, radii, rests_below
from sceneql.contacts.mutual.sphere_warm_kernels import IMPULSE, forget, recall, store
from sceneql.contacts.shape_kernels import clear, surface, velocity
from sceneql.system.signatures_kernels import A, F, I, N

SWEEPS, SHIFTS = 200, 50
"""Most passes over the contacts in a step, for the velocities and for the places."""
MOST_OBJECTS = 3
"""Objects that bear one mass, at most."""
MARGIN = 0.1
"""Gap, relative to the radii, up to which what is near masses that touch takes part."""
CLOSING = 0.2
"""Part of a gap that counts as touching that may close in a step."""

OFF, TARGET, GAP, ROW = 3, 9, 10, 11
"""A contact's row: its normal (3), velocity of the object (3), impulse on the first at IMPULSE [N s] (3), speed at
which it is to part [m/s] (negative: may approach), gap to the object [m], 0 where it is inside."""


@inlined
def allowed(gap, near, speed, slow, h):
    """Speed [m/s] at which a contact is to part, that approaches with ``speed``: across a gap it may approach further,
    and what is an impact there stays one."""
    if gap <= near:
        # The impulse will also undo half of the way that the speed made in the step.
        return -CLOSING * max(0.0, gap + (0.5 * h * max(0.0, speed) if speed <= slow else 0.0)) / h
    return -gap / h if speed <= slow else min(-gap / h, -speed)


@inlined
def touch_objects(k, count, h, near, pull, pairs, rows, y1, floats, ints):
    """Add to the ``count`` contacts those of mass k with objects; the number of all.

    An object bears no mass that is deeper inside it than half its radius, as balls that hang below a floor.
    """
    start = count
    reach = floats[of(ints, k, spheres.RADIUS)]
    slack = (near if near == spheres.TOUCHING else MARGIN) * max(reach, 1e-3)
    x, to = of(ints, k, spheres.X), of(ints, k, spheres.V)
    for one in range(ints[spheres.OBJECTS]):
        at = spheres.HEAD + spheres.BODY * ints[spheres.COUNT] + layout.OBJECT * one
        if count - start == MOST_OBJECTS or clear(floats, ints, at, y1[x], y1[x + 1], y1[x + 2], reach + slack):
            continue
        d, a, b, c = surface(floats, ints, at, y1[x], y1[x + 1], y1[x + 2])
        if d > reach + slack or d < 0.5 * reach:
            continue
        pairs[count, 0], pairs[count, 1] = k, -1 - one
        rows[count, 0], rows[count, 1], rows[count, 2] = a, b, c
        ux, uy, uz = velocity(floats, ints, at, y1[x], y1[x + 1], y1[x + 2])
        rows[count, OFF], rows[count, OFF + 1], rows[count, OFF + 2] = ux, uy, uz
        rows[count, GAP] = max(0.0, d - reach)
        speed = (ux - y1[to]) * a + (uy - y1[to + 1]) * b + (uz - y1[to + 2]) * c
        slow = 2.0 * h * math.sqrt(pull[k, 0] ** 2 + pull[k, 1] ** 2 + pull[k, 2] ** 2)
        rows[count, TARGET] = allowed(d - reach, near * max(reach, 1e-3), speed, slow, h)
        count += 1
    return count


@kernel(N(I, I, F, types.int64[::1], A, A, A, I), inner=True)
def touching(first, others, near, touched, y0, y1, floats, ints):
    """Set touched[k], 0 before, to 1 for masses that touch another at the start or the end of the step; how many."""
    count = 0
    for i in range(ints[spheres.COUNT]):
        for one in range(first[i], first[i + 1]):
            j = others[one]
            reach = (1.0 + near) * radii(i, j, floats, ints)
            if distance(i, j, y1, ints) <= reach or distance(i, j, y0, ints) <= reach:
                touched[i] = touched[j] = 1
                count += 1
    return count


@kernel(types.Tuple((PAIR_ROWS, ROWS))(F, I, I, ROWS, A, A, A, I), inner=True)
def contacts(h, first, others, pull, y0, y1, floats, ints):
    """The contacts (c, 2), the second -1 - number for an object, and (c, ROW).

    First the pairs that touch at the start or the end of the step and, if masses are not elastic, what is near these
    masses, for they are pushed; then the objects.
    """
    n = ints[spheres.COUNT]
    touched = np.zeros(n, dtype=np.int64)
    e = floats[ints[spheres.RESTITUTION]]
    near = spheres.TOUCHING if e >= 1.0 else spheres.SLACK
    if touching(first, others, near, touched, y0, y1, floats, ints) == 0:
        return np.empty((0, 2), dtype=np.int64), np.empty((0, ROW))
    pairs = np.empty((first[n] + n * min(MOST_OBJECTS, ints[spheres.OBJECTS]), 2), dtype=np.int64)
    rows = np.zeros((pairs.shape[0], ROW))
    count = 0
    margin = near if e >= 1.0 else MARGIN
    for i in range(n):
        for one in range(first[i], first[i + 1]):
            j = others[one]
            reach = radii(i, j, floats, ints)
            gap = distance(i, j, y1, ints) - reach
            if touched[i] + touched[j] == 0 or gap > margin * reach or gap <= -reach:
                continue
            speed, slow = approach(i, j, y1, ints), rests_below(i, j, h, pull, floats, ints)
            if e >= 1.0 and speed > slow:
                continue
            rows[count, TARGET] = allowed(gap, near * reach, speed, slow, h)
            if gap <= near * reach and speed > slow:
                rows[count, TARGET] = e * speed
            pairs[count, 0], pairs[count, 1] = i, j
            for c in range(3):
                rows[count, c] = (y1[of(ints, i, spheres.X) + c] - y1[of(ints, j, spheres.X) + c]) / (gap + reach)
            count += 1
    pushed = np.zeros(n, dtype=np.int64)
    for one in range(count):
        pushed[pairs[one, 0]] = pushed[pairs[one, 1]] = 1
    for k in range(n):
        if pushed[k] == 1:
            count = touch_objects(k, count, h, near, pull, pairs, rows, y1, floats, ints)
    return pairs[:count], rows[:count]


@inlined
def push(i, j, px, py, pz, v, inverse):
    """Change velocities v (n, 3) by an impulse on i, and its negative on j."""
    v[i, 0] += inverse[i] * px
    v[i, 1] += inverse[i] * py
    v[i, 2] += inverse[i] * pz
    if j >= 0:
        v[j, 0] -= inverse[j] * px
        v[j, 1] -= inverse[j] * py
        v[j, 2] -= inverse[j] * pz


@kernel(F(N, F, PAIR_ROWS, ROWS, A, ROWS), inner=True)
def sweep(turn, friction, pairs, rows, inverse, v):
    """One pass over the contacts, backwards in odd turns; the largest change of a velocity [m/s]."""
    change = 0.0
    for at in range(pairs.shape[0]):
        one = at if turn % 2 == 0 else pairs.shape[0] - 1 - at
        i, j = pairs[one, 0], pairs[one, 1]
        both = inverse[i] + (inverse[j] if j >= 0 else 0.0)
        if both == 0.0:
            continue
        nx, ny, nz = rows[one, 0], rows[one, 1], rows[one, 2]
        x, y, z = v[i, 0] - rows[one, OFF], v[i, 1] - rows[one, OFF + 1], v[i, 2] - rows[one, OFF + 2]
        if j >= 0:
            x, y, z = x - v[j, 0], y - v[j, 1], z - v[j, 2]
        x, y, z = x - rows[one, TARGET] * nx, y - rows[one, TARGET] * ny, z - rows[one, TARGET] * nz
        # Add the impulse that stops all slip and approach, and project the sum onto Coulomb's cone.
        px, py, pz = rows[one, IMPULSE] - x / both, rows[one, IMPULSE + 1] - y / both, rows[one, IMPULSE + 2] - z / both
        along = px * nx + py * ny + pz * nz
        normal = max(0.0, along)
        part = 0.0
        if friction > 0.0:
            size = math.sqrt((px - along * nx) ** 2 + (py - along * ny) ** 2 + (pz - along * nz) ** 2)
            part = min(1.0, friction * normal / size) if size > 0.0 else 0.0
        px, py, pz = (
            normal * nx + part * (px - along * nx),
            normal * ny + part * (py - along * ny),
            normal * nz + part * (pz - along * nz),
        )
        dx, dy, dz = px - rows[one, IMPULSE], py - rows[one, IMPULSE + 1], pz - rows[one, IMPULSE + 2]
        rows[one, IMPULSE], rows[one, IMPULSE + 1], rows[one, IMPULSE + 2] = px, py, pz
        push(i, j, dx, dy, dz, v, inverse)
        change = max(change, both * math.sqrt(dx * dx + dy * dy + dz * dz))
    return change


@kernel(F(PAIR_ROWS, ROWS, A, ROWS, ROWS, A, I), inner=True)
def part_them(pairs, rows, inverse, x, moved, floats, ints):
    """Move masses that overlap apart, and not into objects; the largest overlap [m] met.

    ``moved`` (n, 3): the ways from the places x (n, 3) so far.
    """
    worst = 0.0
    for one in range(pairs.shape[0]):
        i, j = pairs[one, 0], pairs[one, 1]
        if j < 0:
            into = rows[one, GAP] + moved[i, 0] * rows[one, 0] + moved[i, 1] * rows[one, 1] + moved[i, 2] * rows[one, 2]
            if into < 0.0 and inverse[i] > 0.0:
                worst = max(worst, -into)
                for c in range(3):
                    moved[i, c] -= into * rows[one, c]
            continue
        reach = radii(i, j, floats, ints)
        dx = x[i, 0] + moved[i, 0] - x[j, 0] - moved[j, 0]
        dy = x[i, 1] + moved[i, 1] - x[j, 1] - moved[j, 1]
        dz = x[i, 2] + moved[i, 2] - x[j, 2] - moved[j, 2]
        square = dx * dx + dy * dy + dz * dz
        if square >= reach * reach or square == 0.0:
            continue
        length = math.sqrt(square)
        worst = max(worst, reach - length)
        part = (reach - length) / (length * (inverse[i] + inverse[j]))
        push(i, j, part * dx, part * dy, part * dz, moved, inverse)
    return worst


@kernel(spheres.REST, inner=True)
def rest(h, first, others, pull, y0, y1, floats, ints):
    """End the approach of masses that touch at the end of a step of length h; ``pull`` (n, 3): mean accelerations."""
    pairs, rows = contacts(h, first, others, pull, y0, y1, floats, ints)
    if pairs.shape[0] == 0:
        forget(floats, ints)
        return
    n = ints[spheres.COUNT]
    x, v, moved, inverse = np.empty((n, 3)), np.empty((n, 3)), np.zeros((n, 3)), np.empty(n)
    for k in range(n):
        inverse[k] = floats[of(ints, k, spheres.INVERSE)]
        for c in range(3):
            x[k, c], v[k, c] = y1[of(ints, k, spheres.X) + c], y1[of(ints, k, spheres.V) + c]
    recall(h, pairs, rows, floats, ints)
    for one in range(pairs.shape[0]):
        if rows[one, IMPULSE] != 0.0 or rows[one, IMPULSE + 1] != 0.0 or rows[one, IMPULSE + 2] != 0.0:
            push(
                pairs[one, 0],
                pairs[one, 1],
                rows[one, IMPULSE],
                rows[one, IMPULSE + 1],
                rows[one, IMPULSE + 2],
                v,
                inverse,
            )
    for turn in range(SWEEPS):
        if sweep(turn, floats[ints[spheres.FRICTION]], pairs, rows, inverse, v) < 1e-13:
            break
    store(h, pairs, rows, floats, ints)
    for k in range(n):
        for c in range(3):
            moved[k, c] = 0.5 * h * (v[k, c] - y1[of(ints, k, spheres.V) + c])
    for _ in range(SHIFTS):
        if part_them(pairs, rows, inverse, x, moved, floats, ints) < 1e-13:
            break
    for k in range(n):
        mass = floats[of(ints, k, spheres.MASS)] if inverse[k] > 0.0 else 0.0
        for c in range(3):
            before = y1[of(ints, k, spheres.V) + c]
            y1[of(ints, k, spheres.WORK)] += mass * (
                0.5 * (before * before - v[k, c] * v[k, c]) + floats[ints[spheres.FREE] + 1 + 3 * k + c] * moved[k, c]
            )
            y1[of(ints, k, spheres.V) + c] = v[k, c]
            y1[of(ints, k, spheres.X) + c] += moved[k, c]
