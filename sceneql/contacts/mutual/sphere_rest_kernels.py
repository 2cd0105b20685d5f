# mypy: ignore-errors
"""Masses that rest on one another and on objects: impulses at the end of a step, and removal of overlaps.

Nonnegative normal impulses with Coulomb friction, iterated over the contacts until none approaches (projected
Gauss-Seidel; Moreau 1988). A mass is moved by half the step times its change of velocity, as if the contact force had
acted during the step: so resting masses stay in place, and the work of gravity on that distance is no loss.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.contacts import layout
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import ROWS, approach, of, radii, rests_below
from sceneql.contacts.shape_kernels import clear, surface, velocity
from sceneql.system.signatures_kernels import A, F, I

SWEEPS = 200
NONE = -1


@inlined
def in_touch(k, y1, floats, ints, near, u):
    """Write normals (.., 3) and velocities (.., 3) of the objects that mass k touches to near and u; their number.

    An object bears no mass that is inside it by more than the radius, as balls that hang below a floor.
    """
    count = 0
    reach = floats[of(ints, k, spheres.RADIUS)]
    slack = spheres.TOUCHING * max(reach, 1e-3)
    x = of(ints, k, spheres.X)
    for one in range(ints[spheres.OBJECTS]):
        at = spheres.HEAD + spheres.BODY * ints[spheres.COUNT] + layout.OBJECT * one
        if count == near.shape[0] or clear(floats, ints, at, y1[x], y1[x + 1], y1[x + 2], reach + slack):
            continue
        d, a, b, c = surface(floats, ints, at, y1[x], y1[x + 1], y1[x + 2])
        if d > reach + slack or d < -reach:
            continue
        near[count, 0], near[count, 1], near[count, 2] = a, b, c
        u[count, 0], u[count, 1], u[count, 2] = velocity(floats, ints, at, y1[x], y1[x + 1], y1[x + 2])
        count += 1
    return count


@kernel(types.Tuple((types.int64[:, ::1], ROWS))(F, I, I, ROWS, A, A, I), inner=True)
def contacts(h, first, others, pull, y1, floats, ints):
    """Resting pairs (c, 2), the second -1 for an object, and (c, 9): normal, velocity of the object, impulse."""
    n = ints[spheres.COUNT]
    pairs = np.empty((first[n] + n * min(3, ints[spheres.OBJECTS]), 2), dtype=np.int64)
    rows = np.zeros((pairs.shape[0], 9))
    touched = np.zeros(n, dtype=np.int64)
    count = 0
    for i in range(n):
        for one in range(first[i], first[i + 1]):
            j = others[one]
            reach = radii(i, j, floats, ints)
            square = 0.0
            for c in range(3):
                square += (y1[of(ints, i, spheres.X) + c] - y1[of(ints, j, spheres.X) + c]) ** 2
            if (
                square > (reach * (1.0 + spheres.TOUCHING)) ** 2
                or square == 0.0
                or approach(i, j, y1, ints) > rests_below(i, j, h, pull, floats, ints)
            ):
                continue
            pairs[count, 0], pairs[count, 1] = i, j
            for c in range(3):
                rows[count, c] = (y1[of(ints, i, spheres.X) + c] - y1[of(ints, j, spheres.X) + c]) / math.sqrt(square)
            touched[i] = touched[j] = 1
            count += 1
    if count > 0:
        near, u = np.empty((3, 3)), np.empty((3, 3))
        for k in range(n):
            held = in_touch(k, y1, floats, ints, near, u) if touched[k] == 1 else 0
            for one in range(held):
                pairs[count, 0], pairs[count, 1] = k, NONE
                for c in range(3):
                    rows[count, c], rows[count, 3 + c] = near[one, c], u[one, c]
                count += 1
    return pairs[:count], rows[:count]


@inlined
def push(i, j, px, py, pz, v, floats, ints):
    """Change velocities v (n, 3) by an impulse on i, and its negative on j."""
    a = floats[of(ints, i, spheres.INVERSE)]
    v[i, 0] += a * px
    v[i, 1] += a * py
    v[i, 2] += a * pz
    if j != NONE:
        b = floats[of(ints, j, spheres.INVERSE)]
        v[j, 0] -= b * px
        v[j, 1] -= b * py
        v[j, 2] -= b * pz


@kernel(F(types.int64[:, ::1], ROWS, ROWS, A, I), inner=True)
def sweep(pairs, rows, v, floats, ints):
    """One pass over the contacts; the largest change of a velocity [m/s]."""
    change = 0.0
    for one in range(pairs.shape[0]):
        i, j = pairs[one, 0], pairs[one, 1]
        inverse = floats[of(ints, i, spheres.INVERSE)] + (0.0 if j == NONE else floats[of(ints, j, spheres.INVERSE)])
        if inverse == 0.0:
            continue
        nx, ny, nz = rows[one, 0], rows[one, 1], rows[one, 2]
        x, y, z = v[i, 0] - rows[one, 3], v[i, 1] - rows[one, 4], v[i, 2] - rows[one, 5]
        if j != NONE:
            x, y, z = x - v[j, 0], y - v[j, 1], z - v[j, 2]
        # Add the impulse that stops all slip and approach, and project the sum onto Coulomb's cone.
        px, py, pz = rows[one, 6] - x / inverse, rows[one, 7] - y / inverse, rows[one, 8] - z / inverse
        normal = max(0.0, px * nx + py * ny + pz * nz)
        tangent = px * nx + py * ny + pz * nz
        tx, ty, tz = px - tangent * nx, py - tangent * ny, pz - tangent * nz
        size = math.sqrt(tx * tx + ty * ty + tz * tz)
        part = min(1.0, floats[ints[spheres.FRICTION]] * normal / size) if size > 0.0 else 0.0
        px, py, pz = normal * nx + part * tx, normal * ny + part * ty, normal * nz + part * tz
        dx, dy, dz = px - rows[one, 6], py - rows[one, 7], pz - rows[one, 8]
        rows[one, 6], rows[one, 7], rows[one, 8] = px, py, pz
        push(i, j, dx, dy, dz, v, floats, ints)
        change = max(change, inverse * math.sqrt(dx * dx + dy * dy + dz * dz))
    return change


@kernel(F(types.int64[:, ::1], ROWS, ROWS, A, A, I), inner=True)
def part_them(pairs, rows, moved, y1, floats, ints):
    """Move pairs that overlap apart, ``moved`` (n, 3) in all; the largest overlap [m] met."""
    worst = 0.0
    for one in range(pairs.shape[0]):
        i, j = pairs[one, 0], pairs[one, 1]
        if j == NONE:
            # Do not move it into the object again.
            into = moved[i, 0] * rows[one, 0] + moved[i, 1] * rows[one, 1] + moved[i, 2] * rows[one, 2]
            for c in range(3):
                moved[i, c] -= min(0.0, into) * rows[one, c]
            continue
        square = 0.0
        for c in range(3):
            square += (y1[of(ints, i, spheres.X) + c] + moved[i, c] - y1[of(ints, j, spheres.X) + c] - moved[j, c]) ** 2
        length = math.sqrt(square)
        overlap = radii(i, j, floats, ints) - length
        a, b = floats[of(ints, i, spheres.INVERSE)], floats[of(ints, j, spheres.INVERSE)]
        if overlap <= 0.0 or a + b == 0.0 or length == 0.0:
            continue
        worst = max(worst, overlap)
        for c in range(3):
            d = y1[of(ints, i, spheres.X) + c] + moved[i, c] - y1[of(ints, j, spheres.X) + c] - moved[j, c]
            d *= overlap / (length * (a + b))
            moved[i, c] += a * d
            moved[j, c] -= b * d
    return worst


@kernel(spheres.REST, inner=True)
def rest(h, first, others, pull, y1, floats, ints):
    """End the approach of masses that touch at the end of a step of length h; ``pull`` (n, 3): mean accelerations."""
    pairs, rows = contacts(h, first, others, pull, y1, floats, ints)
    if pairs.shape[0] == 0:
        return
    n = ints[spheres.COUNT]
    v, moved = np.empty((n, 3)), np.zeros((n, 3))
    for k in range(n):
        for c in range(3):
            v[k, c] = y1[of(ints, k, spheres.V) + c]
    for _ in range(SWEEPS):
        if sweep(pairs, rows, v, floats, ints) < 1e-13:
            break
    for k in range(n):
        for c in range(3):
            moved[k, c] = 0.5 * h * (v[k, c] - y1[of(ints, k, spheres.V) + c])
    for _ in range(SWEEPS):
        if part_them(pairs, rows, moved, y1, floats, ints) < 1e-13:
            break
    for k in range(n):
        mass = floats[of(ints, k, spheres.MASS)] if floats[of(ints, k, spheres.INVERSE)] > 0.0 else 0.0
        for c in range(3):
            before = y1[of(ints, k, spheres.V) + c]
            y1[of(ints, k, spheres.WORK)] += mass * (
                0.5 * (before * before - v[k, c] * v[k, c]) + floats[ints[spheres.FREE] + 1 + 3 * k + c] * moved[k, c]
            )
            y1[of(ints, k, spheres.V) + c] = v[k, c]
            y1[of(ints, k, spheres.X) + c] += moved[k, c]
