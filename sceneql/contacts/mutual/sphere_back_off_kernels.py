# mypy: ignore-errors
"""Masses that collide with one another in `local` mode: which pairs may meet in a step.

Their impacts are compiled when the first two come near each other (sphere_meet_kernels).
"""

import math

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import neighbors, of, radii, sort_cells, tied
from sceneql.system.signatures_kernels import BACK_OFF, TERM, A, F, I

meet_all = lazy("sceneql.contacts.mutual.sphere_meet_kernels:meet_all", spheres.MEET)


@inlined
def twice(numbers):
    """A copy of the array of twice its length."""
    more = np.empty(2 * numbers.size, dtype=np.int64)
    for k in range(numbers.size):
        more[k] = numbers[k]
    return more


@kernel(types.Tuple((I, I))(F, A, A, A, I), inner=True)
def candidates(h, y0, y1, floats, ints):
    """The pairs that may meet in the step: start of each mass's pairs (n + 1), and the other masses, of larger number.

    Includes pairs that would meet if either moved as far as the fastest mass, for impacts hand on velocities.
    """
    n = ints[spheres.COUNT]
    first = np.zeros(n + 1, dtype=np.int64)
    longest, widest = 0.0, 0.0
    for k in range(n):
        at = of(ints, k, spheres.X)
        way = 0.0
        for c in range(3):
            floats[ints[spheres.POINTS] + c * n + k] = 0.5 * (y0[at + c] + y1[at + c])
            way += (y1[at + c] - y0[at + c]) ** 2
        longest = max(longest, way)
        widest = max(widest, floats[of(ints, k, spheres.RADIUS)])
    edge = 2.0 * (widest + math.sqrt(longest))
    if not edge > 0.0 or widest == 0.0 or not math.isfinite(edge):
        return first, np.zeros(0, dtype=np.int64)
    sort_cells(edge, floats, ints)
    found = np.empty(n, dtype=np.int64)
    others = np.empty(8 * n + 64, dtype=np.int64)
    points = ints[spheres.POINTS]
    for k in range(n):
        total = first[k]
        for one in range(neighbors(k, edge, found, floats, ints)):
            j = found[one]
            square = 0.0
            for c in range(3):
                square += (floats[points + c * n + k] - floats[points + c * n + j]) ** 2
            fixed = floats[of(ints, k, spheres.INVERSE)] + floats[of(ints, j, spheres.INVERSE)] == 0.0
            # Zero mass: a slot for a particle that is absent now.
            absent = floats[of(ints, k, spheres.MASS)] == 0.0 or floats[of(ints, j, spheres.MASS)] == 0.0
            if fixed or absent or square > (radii(k, j, floats, ints) + 2.0 * math.sqrt(longest)) ** 2:
                continue
            if tied(k, j, ints):
                continue
            if total == others.size:
                others = twice(others)
            others[total] = j
            total += 1
        first[k + 1] = total
    return first, others


@kernel(BACK_OFF, inner=True)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Change y1 so that no mass went through another in the step from t0 to t1."""
    if floats[channels.STEP_END] > 0.0:
        return
    floats[ints[spheres.FREE]] = t1
    first, others = candidates(t1 - t0, y0, y1, floats, ints)
    if first[ints[spheres.COUNT]] > 0:
        meet_all(t1, t1 - t0, first, others, y0, rate0, y1, floats, ints)


@kernel(TERM, inner=True)
def store_free(t, y, rate, floats, ints):
    """At the start of a step, store the accelerations [m/s^2] that the masses have without contacts."""
    at = ints[spheres.FREE]
    if t == floats[at]:
        for k in range(ints[spheres.COUNT]):
            for c in range(3):
                floats[at + 1 + 3 * k + c] = rate[of(ints, k, spheres.V) + c]
