# mypy: ignore-errors
"""Springs that break."""

import math

from sceneql.bodies.mass_spring_kernels import BLOCK
from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import AFTER_STEP

POSITION_AT, WORK_AT, BLOCKS_AT, STIFFNESS_AT, LIMITS_AT, TORN_AT, COUNT, PAIRS_AT = range(8)
"""From PAIRS_AT on the two masses of each spring."""


@kernel(AFTER_STEP, inner=True)
def tear(t0, t1, y0, rate0, y1, floats, ints):
    """Springs beyond their limit of strain lose stiffness and damping; their energy is counted as dissipated.

    Returns whether any spring broke. The energy is added at both ends of the step, as frames inside it already show
    the broken spring.
    """
    torn = False
    position_at, work_at, blocks_at, limits_at = ints[POSITION_AT], ints[WORK_AT], ints[BLOCKS_AT], ints[LIMITS_AT]
    for s in range(ints[COUNT]):
        block = blocks_at + BLOCK * s
        k = floats[block + 1] + floats[block + 2] * floats[ints[STIFFNESS_AT]]
        if k == 0.0:
            continue
        a, b = position_at + 3 * ints[PAIRS_AT + 2 * s], position_at + 3 * ints[PAIRS_AT + 2 * s + 1]
        dx, dy, dz = y1[b] - y1[a], y1[b + 1] - y1[a + 1], y1[b + 2] - y1[a + 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
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
