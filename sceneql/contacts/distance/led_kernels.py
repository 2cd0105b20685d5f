# mypy: ignore-errors
"""Objects that move by themselves, as rigid bodies meet them in `local` mode: their place at the start of a step, and
the velocity and spin that bring them to their place at its end."""

import math

from numba import types

from sceneql.compiled.kernels import kernel
from sceneql.contacts.distance.core_kernels import PLACE
from sceneql.system.signatures_kernels import A, F, I, N

POSITION_AT, ROTATION_AT, FROM_AT, MEMORY_AT, LED = range(5)
"""Integers of an object: offsets of its position and quaternion, which are those of the end of the step; of what is to
be added to the position (3); of its memory: two instants, and its places then."""
MEMORY = 2 * (1 + PLACE)
LED_TYPE = types.void(F, F, A, I, N, A, N, A, N)


@kernel(LED_TYPE, inner=True)
def lead(t0, t1, floats, ints, at, places, place, motions, motion):
    """Write the place at t0 and the mean velocity and spin up to t1 of the object at ints[at:]."""
    early = ints[at + MEMORY_AT]
    late = early + 1 + PLACE
    if floats[late] == t0:
        for c in range(1 + PLACE):
            floats[early + c] = floats[late + c]
    x, q = ints[at + POSITION_AT], ints[at + ROTATION_AT]
    floats[late] = t1
    for c in range(3):
        floats[late + 1 + c] = floats[x + c] + floats[ints[at + FROM_AT] + c]
    size = 0.0
    for c in range(4):
        size += floats[q + c] ** 2
    size = 1.0 / math.sqrt(size)
    for c in range(4):
        floats[late + 4 + c] = size * floats[q + c]
    if floats[early] != t0:  # a step that did not begin where the last one ended
        for c in range(PLACE):
            floats[early + 1 + c] = floats[late + 1 + c]
    h = t1 - t0
    for c in range(PLACE):
        places[place + c] = floats[early + 1 + c]
    for c in range(3):
        motions[motion + c] = (floats[late + 1 + c] - floats[early + 1 + c]) / h
    # q1 q0*, the turn of the step, the shorter way.
    a, b, c, d = floats[early + 4], -floats[early + 5], -floats[early + 6], -floats[early + 7]
    e, f, g, k = floats[late + 4], floats[late + 5], floats[late + 6], floats[late + 7]
    w = e * a - f * b - g * c - k * d
    x, y, z = e * b + f * a + g * d - k * c, e * c + g * a + k * b - f * d, e * d + k * a + f * c - g * b
    sine = math.sqrt(x * x + y * y + z * z)
    rate = 2.0 * math.atan2(sine, abs(w)) / (h * sine) if sine > 0.0 else 0.0
    rate = math.copysign(rate, w)
    motions[motion + 3], motions[motion + 4], motions[motion + 5] = rate * x, rate * y, rate * z
