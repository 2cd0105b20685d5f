# mypy: ignore-errors
"""The force of a spring between masses of any models."""

import math

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM


@kernel(TERM, inner=True)
def spring(t, y, rate, floats, ints):
    """Adds the pull to both ends, and to the work what the damping takes (half to each) and what holds a place.

    ints: for each end position_at, velocity_at, work_at (or -1, the place in the floats, -1); stiffness_at,
    damping_at, rest_at; for each end -1 (or its velocity in the floats).
    """
    a, b = ints[0], ints[3]
    va, vb = ints[1], ints[4]
    dx = (y[b] if b >= 0 else floats[vb]) - (y[a] if a >= 0 else floats[va])
    dy = (y[b + 1] if b >= 0 else floats[vb + 1]) - (y[a + 1] if a >= 0 else floats[va + 1])
    dz = (y[b + 2] if b >= 0 else floats[vb + 2]) - (y[a + 2] if a >= 0 else floats[va + 2])
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return
    dx, dy, dz = dx / length, dy / length, dz / length
    ua, ub = ints[9], ints[10]
    if a >= 0:
        leading = dx * y[va] + dy * y[va + 1] + dz * y[va + 2]
    else:
        leading = dx * floats[ua] + dy * floats[ua + 1] + dz * floats[ua + 2]
    if b >= 0:
        following = dx * y[vb] + dy * y[vb + 1] + dz * y[vb + 2]
    else:
        following = dx * floats[ub] + dy * floats[ub + 1] + dz * floats[ub + 2]
    opening = following - leading
    damping = floats[ints[7]]
    pull = floats[ints[6]] * (length - floats[ints[8]]) + damping * opening
    lost = damping * opening * opening
    if a >= 0:
        rate[va] += pull * dx
        rate[va + 1] += pull * dy
        rate[va + 2] += pull * dz
        rate[ints[2]] += 0.5 * lost if b >= 0 else lost - pull * following
    if b >= 0:
        rate[vb] -= pull * dx
        rate[vb + 1] -= pull * dy
        rate[vb + 2] -= pull * dz
        rate[ints[5]] += 0.5 * lost if a >= 0 else lost + pull * leading
