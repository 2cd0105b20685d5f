# mypy: ignore-errors
"""Springs that break."""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.bodies.mass_spring_kernels import BLOCK
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, A, F, I

POSITION_AT, WORK_AT, BLOCKS_AT, STIFFNESS_AT, LIMITS_AT, TORN_AT, COUNT, PAIRS_AT = range(8)
"""From PAIRS_AT on the two masses of each spring. Behind TORN_AT's number: how many steps in a row were too long."""

FEW = 100
"""Springs of a net up to which the instants of tears are located: where a tear runs through a cloth each thread would
take some steps more, which made one of 5000 springs 3.5 times as slow."""
NEAR, MOST_TRIED = 1e-9, 40
"""Part of its limit by which a spring may be longer as it tears; steps after which it tears all the same."""
LEAST, GREATEST = 0.1, 0.999999
"""Parts of a step that is too long."""


@lean_inlined
def length_of(y, a, b):
    """The distance of two places in y."""
    dx, dy, dz = y[b] - y[a], y[b + 1] - y[a + 1], y[b + 2] - y[a + 2]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@lean(types.UniTuple(F, 2)(A, A, A, I))
def beyond(y0, y1, floats, ints):
    """How many springs are beyond their limit at the end of a step; the part of it at which the first reaches this.

    As a straight line between their lengths at both ends tells; 1 where none is longer than NEAR allows, or was
    so before.
    """
    count, part = 0.0, 1.0
    position_at, limits_at = ints[POSITION_AT], ints[LIMITS_AT]
    for s in range(ints[COUNT]):
        a, b = position_at + 3 * ints[PAIRS_AT + 2 * s], position_at + 3 * ints[PAIRS_AT + 2 * s + 1]
        length, most, block = length_of(y1, a, b), floats[limits_at + s], ints[BLOCKS_AT] + BLOCK * s
        if length <= most or floats[block + 1] + floats[block + 2] * floats[ints[STIFFNESS_AT]] == 0.0:
            continue
        count += 1.0
        if length > (1.0 + NEAR) * most:
            before = length_of(y0, a, b)
            if before < most:
                part = min(part, max(LEAST, min(((1.0 + 0.5 * NEAR) * most - before) / (length - before), GREATEST)))
    return count, part


@kernel(AFTER_STEP, inner=True)
def tear(t0, t1, y0, rate0, y1, floats, ints):
    """Springs beyond their limit of strain lose stiffness and damping; their energy is counted as dissipated.

    Where the step may be taken back it is asked to end where the first of FEW reaches its limit. Returns whether any
    spring broke. The energy is added at both ends of the step, as frames inside it already show
    the broken spring.
    """
    count, part = beyond(y0, y1, floats, ints)
    tried = ints[TORN_AT] + 1
    if part < 1.0 and ints[COUNT] <= FEW and floats[channels.EARLIER] > 0.0 and floats[tried] < MOST_TRIED:
        floats[tried] += 1.0
        floats[channels.EARLIER] = min(floats[channels.EARLIER], part)
        return False
    floats[tried] = 0.0
    if count == 0.0:
        return False
    torn = False
    position_at, work_at, blocks_at, limits_at = ints[POSITION_AT], ints[WORK_AT], ints[BLOCKS_AT], ints[LIMITS_AT]
    for s in range(ints[COUNT]):
        block = blocks_at + BLOCK * s
        k = floats[block + 1] + floats[block + 2] * floats[ints[STIFFNESS_AT]]
        if k == 0.0:
            continue
        a, b = position_at + 3 * ints[PAIRS_AT + 2 * s], position_at + 3 * ints[PAIRS_AT + 2 * s + 1]
        length = length_of(y1, a, b)
        if length <= floats[limits_at + s]:
            continue
        lost = 0.5 * k * (length - floats[block]) ** 2
        y0[work_at] += lost
        y1[work_at] += lost
        for c in range(1, BLOCK):
            floats[block + c] = 0.0
        floats[ints[TORN_AT]] += 1.0
        torn = True
    return torn
