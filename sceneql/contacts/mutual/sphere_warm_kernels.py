# mypy: ignore-errors
"""Impulses of the last step's contacts, from which the next step's sweeps begin (sphere_rest_kernels).

So few sweeps a step are enough for a pile, whose forces change slowly (Catto 2005, warm starting). They stand in the
floats after the masses' free accelerations: length of that step (0: none), the start of each mass's contacts (n + 1)
and, for each contact, its second body and the impulse [N s].
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import PAIR_ROWS, ROWS
from sceneql.system.signatures_kernels import A, F, I

IMPULSE, ENTRY = 6, 4
"""Place of the impulse in a contact's row, and floats of a contact in the memory."""


@inlined
def memory(ints):
    """Where the memory begins in the floats."""
    return ints[spheres.FREE] + 1 + 3 * ints[spheres.COUNT]


@inlined
def forget(floats, ints):
    """Begin the next step from nothing."""
    floats[memory(ints)] = 0.0


@kernel(types.void(F, PAIR_ROWS, ROWS, A, I), inner=True)
def recall(h, pairs, rows, floats, ints):
    """Write the normal parts of the last step's impulses to the contacts that were there, for a step of length h."""
    at = memory(ints)
    if floats[at] == 0.0:
        return
    starts, entries = at + 1, at + 2 + ints[spheres.COUNT]
    for one in range(pairs.shape[0]):
        k = pairs[one, 0]
        for entry in range(int(floats[starts + k]), int(floats[starts + k + 1])):
            place = entries + ENTRY * entry
            if int(floats[place]) != pairs[one, 1]:
                continue
            along = 0.0
            for c in range(3):
                along += floats[place + 1 + c] * rows[one, c]
            for c in range(3):
                rows[one, IMPULSE + c] = max(0.0, along) * rows[one, c] * h / floats[at]


@kernel(types.void(F, PAIR_ROWS, ROWS, A, I), inner=True)
def store(h, pairs, rows, floats, ints):
    """Keep the impulses of a step of length h, of as many contacts as there is room for."""
    n, count = ints[spheres.COUNT], min(pairs.shape[0], spheres.MOST_WARM * ints[spheres.COUNT])
    at = memory(ints)
    floats[at] = h
    starts, entries = at + 1, at + 2 + n
    place = np.zeros(n + 1, dtype=np.int64)
    for one in range(count):
        place[pairs[one, 0] + 1] += 1
    for k in range(n):
        place[k + 1] += place[k]
    for k in range(n + 1):
        floats[starts + k] = place[k]
    for one in range(count):
        to = entries + ENTRY * place[pairs[one, 0]]
        place[pairs[one, 0]] += 1
        floats[to] = pairs[one, 1]
        for c in range(3):
            floats[to + 1 + c] = rows[one, IMPULSE + c]
