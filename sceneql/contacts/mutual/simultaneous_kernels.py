# mypy: ignore-errors
"""Impacts of several touching bodies at one instant, as a chain of impulses.

In each round the contacts that approach have their impulses at once: those of the plastic impact, nonnegative and only
where the approach ends (Moreau 1988), times 1 + restitution. What they hand on makes other contacts approach, which
have theirs in the next round, until none approaches. Elastic impulses are reflections at the bodies' metric, so the
energy stays, and so does every symmetry of the arrangement (Smith, Kaufman, Vouga, Tamstorf & Grinspun, Reflections on
simultaneous impact, 2012). Where restitution is so small that infinitely many rounds end in finite time, and without
any, the contacts end plastically, all at once.

A contact is its two bodies (NONE: an object that nothing moves) and its normal towards the first of them.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import A, F, N

NONE = -1
MOST_ROUNDS = 1000
MOST_SWEEPS = 10000
EXACT = 1e-16
"""Change of a velocity, relative to the fastest approach, at which the impulses of a round are found."""
ROUNDING = 1e-14
"""Approach, relative to the fastest one, that is no impact in any case."""
COLLAPSED = 1e-8
"""Approach, relative to the fastest one, below which an impact that takes energy ends plastically."""

PAIRS = types.int64[:, ::1]
ROWS = types.float64[:, ::1]


@inlined
def parting(one, pairs, normals, v):
    """Speed [m/s] at which the bodies of a contact separate; negative where they approach."""
    i, j = pairs[one, 0], pairs[one, 1]
    speed = 0.0
    for c in range(3):
        speed += normals[one, c] * (v[i, c] - (0.0 if j == NONE else v[j, c]))
    return speed


@inlined
def push(one, p, pairs, normals, inverse, v):
    """Change the velocities v (n, 3) by an impulse p [N s] of a contact along its normal."""
    i, j = pairs[one, 0], pairs[one, 1]
    for c in range(3):
        v[i, c] += inverse[i] * p * normals[one, c]
        if j != NONE:
            v[j, c] -= inverse[j] * p * normals[one, c]


@kernel(types.void(PAIRS, ROWS, A, types.boolean[::1], F, ROWS, A), inner=True)
def plastic(pairs, normals, inverse, active, fastest, v, found):
    """Change v (n, 3) so that no active contact approaches, by impulses ``found`` (c,) >= 0 where they end it."""
    for one in range(found.size):
        found[one] = 0.0
    for _ in range(MOST_SWEEPS):
        change = 0.0
        for one in range(found.size):
            i, j = pairs[one, 0], pairs[one, 1]
            both = inverse[i] + (0.0 if j == NONE else inverse[j])
            if not active[one] or both == 0.0:
                continue
            p = max(0.0, found[one] - parting(one, pairs, normals, v) / both)
            change = max(change, abs(p - found[one]) * both)
            push(one, p - found[one], pairs, normals, inverse, v)
            found[one] = p
        if change <= EXACT * fastest:
            break


@inlined
def rub(one, friction, normal, pairs, normals, inverse, v):
    """Coulomb friction of a contact's impulse ``normal`` [N s], which never reverses the slip; the energy lost [J]."""
    i, j = pairs[one, 0], pairs[one, 1]
    both = inverse[i] + (0.0 if j == NONE else inverse[j])
    along, square = parting(one, pairs, normals, v), 0.0
    for c in range(3):
        square += (v[i, c] - (0.0 if j == NONE else v[j, c]) - along * normals[one, c]) ** 2
    if not square > 0.0:
        return 0.0
    part = min(1.0 / both, friction * normal / math.sqrt(square))
    for c in range(3):
        p = part * (v[i, c] - (0.0 if j == NONE else v[j, c]) - along * normals[one, c])
        v[i, c] -= inverse[i] * p
        if j != NONE:
            v[j, c] += inverse[j] * p
    return part * square * (1.0 - 0.5 * both * part)


@kernel(N(PAIRS, ROWS, A, F, F, F, ROWS, A))
def collide_at_once(pairs, normals, inverse, restitution, friction, still, v, lost):
    """Change the velocities v (n, 3) [m/s] by the impacts of touching bodies, until none approaches another faster than
    ``still`` [m/s]; the number of impacts.

    ``pairs`` (c, 2), ``normals`` (c, 3), ``inverse`` (n,): inverse masses [1/kg], 0 for a fixed body. Adds to ``lost``
    (c,) the kinetic energy [J] that the impulses of each contact take out.
    """
    count = pairs.shape[0]
    found, active = np.zeros(count), np.zeros(count, dtype=np.bool_)
    ended = v.copy()
    hits, fastest = 0, 0.0
    for one in range(count):
        fastest = max(fastest, -parting(one, pairs, normals, v))
    for turn in range(MOST_ROUNDS + 1):
        now = 0.0
        for one in range(count):
            now = max(now, -parting(one, pairs, normals, v))
        if now <= max(still, ROUNDING * fastest):
            break
        last = restitution == 0.0 or turn == MOST_ROUNDS or (restitution < 1.0 and now < COLLAPSED * fastest)
        for one in range(count):
            active[one] = last or parting(one, pairs, normals, v) < -max(still, ROUNDING * fastest)
        for k in range(v.shape[0]):
            for c in range(3):
                ended[k, c] = v[k, c]
        plastic(pairs, normals, inverse, active, fastest, ended, found)
        for one in range(count):
            hits += found[one] > 0.0
            found[one] *= 1.0 if last else 1.0 + restitution
            lost[one] -= 0.5 * found[one] * parting(one, pairs, normals, v)
        for one in range(count):
            push(one, found[one], pairs, normals, inverse, v)
        for one in range(count):
            lost[one] -= 0.5 * found[one] * parting(one, pairs, normals, v)
        for one in range(count if friction > 0.0 else 0):
            if found[one] > 0.0:
                lost[one] += rub(one, friction, found[one], pairs, normals, inverse, v)
        if last:
            break
    return hits
