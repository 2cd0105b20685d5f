# mypy: ignore-errors
"""Impacts of masses with one another within a step, in order of time, then rest (sphere_back_off_kernels).

In the step a mass moves with its mean velocity and its acceleration at the start; an impact changes both ends of the
rest of its path. A pass resolves all pairs of masses that are each other's next impact, so that the order of masses
does not matter.
"""

import math

import numpy as np

from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.impact_kernels import count_hit
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import ROWS, distance, impulse, of, radii, rests_below
from sceneql.system.signatures_kernels import A, F, I, N

MOST_PASSES = 100
MOST_HITS = 8
"""Impacts of a pair in one step after which it is left to `rest`, where masses are not elastic."""

rest = lazy("sceneql.contacts.mutual.sphere_rest_kernels:rest", spheres.REST)


@inlined
def relative(i, j, left, y1, mean, pull, r, v, ints):
    """Place r and velocity v of mass i relative to j, ``left`` [s] before the step's end."""
    for c in range(3):
        r[c] = y1[of(ints, i, spheres.X) + c] - y1[of(ints, j, spheres.X) + c] - left * (mean[i, c] - mean[j, c])
        v[c] = y1[of(ints, i, spheres.V) + c] - y1[of(ints, j, spheres.V) + c] - left * (pull[i, c] - pull[j, c])


@kernel(F(N, N, F, A, ROWS, ROWS, A, A, A, A, I), inner=True)
def meet(i, j, h, since, mean, pull, y1, r, v, floats, ints):
    """Time [s] before the step's end at which two masses meet fast enough for an impact; -1 if they do not."""
    left = h - max(since[i], since[j])
    relative(i, j, left, y1, mean, pull, r, v, ints)
    reach = radii(i, j, floats, ints)
    square, b, speed2 = -reach * reach, 0.0, 0.0
    for c in range(3):
        w = mean[i, c] - mean[j, c]
        square += r[c] * r[c]
        b += r[c] * w
        speed2 += w * w
    if b >= 0.0:
        return -1.0
    if square > 1e-12 * reach * reach:
        inside = b * b - speed2 * square
        if inside < 0.0:
            return -1.0
        left -= square / (math.sqrt(inside) - b)
        if left < 0.0:
            return -1.0
        relative(i, j, left, y1, mean, pull, r, v, ints)
    vn = (v[0] * r[0] + v[1] * r[1] + v[2] * r[2]) / reach
    return left if -vn > rests_below(i, j, h, pull, floats, ints) else -1.0


@inlined
def collide(i, j, left, t1, h, since, mean, pull, y1, r, v, floats, ints):
    """The impact of two masses ``left`` [s] before the step's end; each is booked half of the energy lost.

    That is kinetic energy, less the work of the free accelerations on what the impact changes of the path.
    """
    relative(i, j, left, y1, mean, pull, r, v, ints)
    px, py, pz, speed = impulse(i, j, r, v, floats, ints)
    count_hit(floats, ints[spheres.TALLY], t1 - left, speed)
    lost = 0.0
    for one in range(2):
        k = i if one == 0 else j
        inverse = floats[of(ints, k, spheres.INVERSE)] * (1.0 if one == 0 else -1.0)
        if inverse == 0.0:
            continue
        mass = floats[of(ints, k, spheres.MASS)]
        for c in range(3):
            add = inverse * (px if c == 0 else (py if c == 1 else pz))
            free = floats[ints[spheres.FREE] + 1 + 3 * k + c]
            lost -= mass * add * (y1[of(ints, k, spheres.V) + c] + 0.5 * add - free * left)
            y1[of(ints, k, spheres.V) + c] += add
            y1[of(ints, k, spheres.X) + c] += left * add
            mean[k, c] += add
        since[k] = h - left
    y1[of(ints, i, spheres.WORK)] += 0.5 * lost
    y1[of(ints, j, spheres.WORK)] += 0.5 * lost


@kernel(spheres.MEET, inner=True)
def meet_all(t1, h, first, others, y0, rate0, y1, floats, ints):
    """Resolve in y1 the impacts of the pairs found in the step of length h up to t1."""
    n = ints[spheres.COUNT]
    mean, pull = np.empty((n, 3)), np.empty((n, 3))
    for k in range(n):
        for c in range(3):
            mean[k, c] = (y1[of(ints, k, spheres.X) + c] - y0[of(ints, k, spheres.X) + c]) / h
            # Not the mean acceleration of the step, which may contain impulses by objects.
            pull[k, c] = rate0[of(ints, k, spheres.V) + c]
    since, next_left = np.zeros(n), np.empty(n)
    partner, row = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    hits = np.zeros(others.size, dtype=np.int64)
    e = floats[ints[spheres.RESTITUTION]]
    most = MOST_PASSES if e >= 1.0 else (MOST_HITS if e > 0.0 else 1)
    for i in range(n if e == 0.0 else 0):
        # Without restitution what touches parts or stays together, all at once.
        for one in range(first[i], first[i + 1]):
            reach = (1.0 + spheres.SLACK) * radii(i, others[one], floats, ints)
            hits[one] = distance(i, others[one], y0, ints) <= reach
    r, v = np.empty(3), np.empty(3)
    for _ in range(MOST_PASSES):
        for k in range(n):
            next_left[k], partner[k] = -1.0, -1
        for i in range(n):
            for one in range(first[i], first[i + 1]):
                j = others[one]
                if hits[one] >= most:
                    continue
                left = meet(i, j, h, since, mean, pull, y1, r, v, floats, ints)
                if left < 0.0:
                    continue
                # Of simultaneous pairs both masses take the first in the list.
                if left > next_left[i]:
                    next_left[i], partner[i], row[i] = left, j, one
                if left > next_left[j]:
                    next_left[j], partner[j] = left, i
        met = False
        for i in range(n):
            j = partner[i]
            if j > i and partner[j] == i:
                hits[row[i]] += 1
                collide(i, j, next_left[i], t1, h, since, mean, pull, y1, r, v, floats, ints)
                met = True
        if not met:
            break
    rest(h, first, others, pull, y0, y1, floats, ints)
