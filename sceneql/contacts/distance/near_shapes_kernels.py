# mypy: ignore-errors
"""Which shapes of rigid bodies come near each other in a step."""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts.distance.convex import POINT as MASS_SHAPE
from sceneql.contacts.distance.convex import SHAPE, SKINNED
from sceneql.contacts.distance.rigid_layout import BODIES, JOINED_AT, SHAPES, SHAPES_AT
from sceneql.contacts.distance.rigid_rows_kernels import MOTION, PLACE
from sceneql.contacts.distance.swept_boxes_kernels import BOX, near_pairs, swept_box
from sceneql.system.signatures_kernels import A, F, I, N


@lean(F(A, N, F))
def reach_of(motions, of, reach):
    """The largest speed of any point of a body."""
    v = math.sqrt(motions[of] ** 2 + motions[of + 1] ** 2 + motions[of + 2] ** 2)
    return v + reach * math.sqrt(motions[of + 3] ** 2 + motions[of + 4] ** 2 + motions[of + 5] ** 2)


@lean(F(A, A, N, N, F))
def speed_at(places, motions, a, b, reach):
    """The largest speed that the motion of shape b gives a point within a reach of the center of shape a."""
    far = 0.0
    for c in range(3):
        far += (places[PLACE * a + c] - places[PLACE * b + c]) ** 2
    return reach_of(motions, MOTION * b, math.sqrt(far) + reach)


@lean(types.boolean(I, N, N))
def joined(ints, a, b):
    """Whether a tie joins two shapes' bodies; a < b."""
    at = ints[JOINED_AT]
    low, high = at + 1, at + 1 + 2 * ints[at]
    while low < high:
        middle = low + 2 * ((high - low) // 4)
        if ints[middle] == a and ints[middle + 1] == b:
            return True
        if ints[middle] < a or (ints[middle] == a and ints[middle + 1] < b):
            low = middle + 2
        else:
            high = middle
    return False


@lean(types.void(F, A, I, A, A, A, F, A, A), inner=True)
def sweep(h, floats, ints, places, motions, before, more, boxes, room):
    """Write the boxes around all that the shapes sweep, wider by what they reach at the speeds of ``before``."""
    n, head = ints[BODIES], ints[SHAPES_AT]
    for k in range(ints[SHAPES]):
        if ints[head + SHAPE * k] == MASS_SHAPE:
            for c in range(3):
                boxes[BOX * k + c], boxes[BOX * k + 3 + c] = math.inf, -math.inf
            continue
        reach, margin = floats[ints[head + SHAPE * k + 1] + 1], 0.0
        if k < n:
            margin = h * reach_of(before, MOTION * k, reach) + more * reach
        swept_box(
            floats, ints, head + SHAPE * k, places, PLACE * k, motions, MOTION * k, h, margin, room, boxes, BOX * k
        )


@kernel(types.int64[:, ::1](A, N), inner=True)
def pairs_of(boxes, shapes):
    """The pairs of boxes that meet (m, 2), ascending."""
    pairs = np.empty((8 * shapes + 64, 2), dtype=np.int64)
    found = near_pairs(boxes, pairs)
    if found > pairs.shape[0]:
        pairs = np.empty((found, 2), dtype=np.int64)
        near_pairs(boxes, pairs)
    return pairs[:found]


@kernel(types.int64[:, ::1](A, I, N, A, A))
def standing_pairs(floats, ints, shapes, places, room):
    """The pairs of shapes at rest whose boxes meet (m, 2), ascending; the shapes begin the integers."""
    boxes, still = np.empty(BOX * shapes), np.zeros(MOTION)
    for k in range(shapes):
        swept_box(floats, ints, SHAPE * k, places, PLACE * k, still, 0, 0.0, 0.0, room, boxes, BOX * k)
    return pairs_of(boxes, shapes)


@lean_inlined
def is_skinned(ints, a, b):
    """Whether a pair of shapes touches by skins."""
    head = ints[SHAPES_AT]
    return ints[head + SHAPE * a] == SKINNED or ints[head + SHAPE * b] == SKINNED
