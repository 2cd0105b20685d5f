# mypy: ignore-errors
"""Which of many bodies may come near each other in a step: boxes around all that they sweep, sorted along an axis."""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import kernel, lean
from sceneql.contacts.distance.convex import HALF_SPACE
from sceneql.contacts.distance.core_kernels import (
    FLOATS,
    HEAD,
    INTS,
    KIND,
    RADIUS,
    REACH,
    VERTICES,
    at3,
    dot,
    farthest,
    load,
)
from sceneql.system.signatures_kernels import A, F, I, N

BOX = 6
"""Numbers of a box: its low and its high corner [m]."""


@lean(types.void(A, I, N, A, N, A, N, F, F, A, A, N))
def swept_box(floats, ints, shape, places, at, motions, of, h, margin, room, boxes, to):
    """Writes a box around all places of a shape in a step of h [s], wider by ``margin`` [m] on all sides.

    Of a half space the whole space. The motion is that of first_touch_kernels.
    """
    if ints[shape + KIND] == HALF_SPACE:
        for c in range(3):
            boxes[to + c], boxes[to + 3 + c] = -math.inf, math.inf
        return
    f, i = ints[shape + FLOATS], ints[shape + INTS]
    load(floats, ints, shape, places, at, 0.0, 0.0, 0.0, room, HEAD)
    wx, wy, wz = at3(motions, of + 3)
    reach = floats[f + REACH]
    turned = math.sqrt(dot(wx, wy, wz, wx, wy, wz)) * h * reach
    for c in range(3):
        x, y, z = 1.0 * (c == 0), 1.0 * (c == 1), 1.0 * (c == 2)
        low = farthest(room, HEAD, ints[i + VERTICES], -x, -y, -z)[0] + floats[f + RADIUS] + turned
        high = farthest(room, HEAD, ints[i + VERTICES], x, y, z)[0] + floats[f + RADIUS] + turned
        p, q = places[at + c], places[at + c] + h * motions[of + c]
        # A little wider, for rounding.
        more = margin + 1e-14 * (abs(p) + abs(q) + reach)
        boxes[to + c] = min(p, q) - (min(low, reach) + more)
        boxes[to + 3 + c] = max(p, q) + (min(high, reach) + more)


@kernel(types.void(A, N, I), inner=True)
def sort_low(boxes, axis, order):
    """Sorts the numbers of the boxes by their low sides along an axis, equal ones by number."""
    n = order.size
    other = np.empty(n, dtype=np.int64)
    for k in range(n):
        order[k] = k
    width = 1
    while width < n:
        for first in range(0, n, 2 * width):
            middle, end = min(first + width, n), min(first + 2 * width, n)
            p, q = first, middle
            for k in range(first, end):
                left = p < middle
                if left and q < end:
                    left = boxes[BOX * order[p] + axis] <= boxes[BOX * order[q] + axis]
                if left:
                    other[k] = order[p]
                    p += 1
                else:
                    other[k] = order[q]
                    q += 1
        for k in range(n):
            order[k] = other[k]
        width *= 2


@kernel(N(A, types.int64[:, ::1]))
def near_pairs(boxes, pairs):
    """The number of pairs i < j of boxes (n BOX,) that meet, and the pairs (m, 2) in ascending order.

    Where there are more than m none is written, and the call is to be repeated with room for all of them.
    """
    n = boxes.size // BOX
    # Along the axis on which the centers differ most.
    axis, widest = 0, -1.0
    for c in range(3):
        low, high = math.inf, -math.inf
        for k in range(n):
            p, q = boxes[BOX * k + c], boxes[BOX * k + 3 + c]
            if math.isfinite(p) and math.isfinite(q):
                low, high = min(low, p + q), max(high, p + q)
        if high - low > widest:
            axis, widest = c, high - low
    order = np.empty(n, dtype=np.int64)
    sort_low(boxes, axis, order)
    u, v = (axis + 1) % 3, (axis + 2) % 3
    starts = np.zeros(n + 1, dtype=np.int64)
    firsts = starts
    total = 0
    found = np.empty((0, 2), dtype=np.int64)
    for turn in range(2):
        if turn == 1:
            if total > pairs.shape[0]:
                return total
            found = np.empty((total, 2), dtype=np.int64)
            # Places by the larger number first, so that a stable pass by the smaller one leaves them in order.
            for k in range(n):
                starts[k + 1] += starts[k]
            firsts = starts.copy()
        for p in range(n):
            one = BOX * order[p]
            q = p + 1
            while q < n and boxes[BOX * order[q] + axis] <= boxes[one + 3 + axis]:
                two = BOX * order[q]
                if (
                    boxes[one + u] <= boxes[two + 3 + u]
                    and boxes[two + u] <= boxes[one + 3 + u]
                    and boxes[one + v] <= boxes[two + 3 + v]
                    and boxes[two + v] <= boxes[one + 3 + v]
                ):
                    i, j = min(order[p], order[q]), max(order[p], order[q])
                    if turn == 0:
                        starts[j + 1] += 1
                        total += 1
                    else:
                        found[firsts[j], 0], found[firsts[j], 1] = i, j
                        firsts[j] += 1
                q += 1
    counts = np.zeros(n + 1, dtype=np.int64)
    for k in range(total):
        counts[found[k, 0] + 1] += 1
    for k in range(n):
        counts[k + 1] += counts[k]
    for k in range(total):
        i = found[k, 0]
        pairs[counts[i], 0], pairs[counts[i], 1] = i, found[k, 1]
        counts[i] += 1
    return total
