# mypy: ignore-errors
"""Which pieces of lines along a velocity are drawn: none that comes near to an earlier one."""

import math

import numpy as np

from sceneql.compiled.kernels import kernel, lean
from sceneql.system.signatures_kernels import A, F, I, N

BACK = 4
"""Steps after which a line may have come back to its start."""
CLOSED = 0.6
"""Distance from its start, in steps, at which it has."""


@lean(N(A, N, A, F, I, N))
def box_of(points, at, low, side, boxes, axes):
    """The number of the box that a point stands in; of one outside, of the nearest."""
    found = 0
    for c in range(axes):
        here = math.floor((points[at + c] - low[c]) / side)
        found = found * boxes[c] + min(max(here, 0), boxes[c] - 1)
    return found


@lean(N(A, N, N, N, F))
def length_of(path, points, count, k, step):
    """The number of points of way k until it rests, or comes back to its start."""
    for n in range(1, points):
        before, at = 3 * ((n - 1) * count + k), 3 * (n * count + k)
        moved, away = 0.0, 0.0
        for c in range(3):
            moved += abs(path[at + c] - path[before + c])
            away += (path[at + c] - path[3 * k + c]) ** 2
        if moved == 0.0:
            return n
        if n >= BACK and math.sqrt(away) < CLOSED * step:
            return n + 1
    return points


@kernel(N(A, A, N, A, F, F, I, N, N, A))
def choose(forth, back, count, low, side, step, boxes, axes, least, found):
    """Write the ends (k, 2, 3) of the pieces that are drawn to ``found``; how many there are.

    ``forth``, ``back``: points (steps, count, 3) of ways from each start; ``side``, ``boxes``: of the boxes [m], of
    which each holds pieces of one line; ``least``: pieces of a line, shorter ones are left out.
    """
    whole = 1
    for c in range(axes):
        whole *= boxes[c]
    taken, mine = np.zeros(whole, dtype=np.int64), np.zeros((forth.size + back.size) // 3, dtype=np.int64)
    total = 0
    for k in range(count):
        if taken[box_of(forth, 3 * k, low, side, boxes, axes)] != 0:
            continue
        first, own = total, 0
        for way in range(2):
            path = forth if way == 0 else back
            for n in range(1, length_of(path, path.size // (3 * count), count, k, step)):
                at, before = 3 * (n * count + k), 3 * ((n - 1) * count + k)
                box = box_of(path, at, low, side, boxes, axes)
                if taken[box] != 0:
                    break
                for c in range(3):
                    found[6 * total + c], found[6 * total + 3 + c] = path[before + c], path[at + c]
                mine[own] = box
                own += 1
                total += 1
        if own < least:
            total = first
            continue
        for j in range(own):
            taken[mine[j]] = 1
    return total
