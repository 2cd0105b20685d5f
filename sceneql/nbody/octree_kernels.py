# mypy: ignore-errors
"""An octree over bodies in the order of Morton keys, with moments of each node up to the second.

Nodes stand in floats, NODE numbers each, children side by side and behind their parents (Barnes & Hut 1986, Nature 324;
Warren & Salmon 1993 for the keys). A chain of cells with one child each is one node.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel
from sceneql.system.signatures_kernels import A, N

X, Y, Z, M, SXX, SXY, SXZ, SYY, SYZ, SZZ, TRACE, RADIUS, CHILD, CHILDREN, BEGIN, END, NODE = range(17)
"""Center of mass; mass; three times the second moments about it; half the sum of SXX, SYY, SZZ; radius of the bodies;
first child and their number (0: a leaf); the bodies."""
LEAF = 16
GROUP = 64
DEEPEST = 21
"""Bits of a key along each axis."""
DIGIT = 11
K = types.int64[::1]


@inlined
def spread_bits(n):
    """Every bit of 21 moved to three times its place."""
    n = (n | (n << 32)) & 0x1F00000000FFFF
    n = (n | (n << 16)) & 0x1F0000FF0000FF
    n = (n | (n << 8)) & 0x100F00F00F00F00F
    n = (n | (n << 4)) & 0x10C30C30C30C30C3
    return (n | (n << 2)) & 0x1249249249249249


@kernel(types.void(A, N, N, N, K, K))
def sort_by_key(floats, n, room, at, keys, order):
    """Morton keys (n,) of the places at floats[at:] (x, then y, then z, each with ``room``), sorted; and the order."""
    low = np.full(3, np.inf)
    high = np.full(3, -np.inf)
    for c in range(3):
        for k in range(n):
            low[c] = min(low[c], floats[at + c * room + k])
            high[c] = max(high[c], floats[at + c * room + k])
    side = max(high[0] - low[0], max(high[1] - low[1], high[2] - low[2]))
    scale = (2.0**DEEPEST - 1.0) / side if side > 0.0 else 0.0
    for k in range(n):
        keys[k] = 0
        order[k] = k
        for c in range(3):
            keys[k] |= spread_bits(int((floats[at + c * room + k] - low[c]) * scale)) << (2 - c)
    other_keys = np.empty(n, dtype=np.int64)
    other = np.empty(n, dtype=np.int64)
    mask = (1 << DIGIT) - 1
    counts = np.empty(mask + 2, dtype=np.int64)
    for shift in range(0, 3 * DEEPEST, DIGIT):
        for k in range(mask + 2):
            counts[k] = 0
        for k in range(n):
            counts[((keys[k] >> shift) & mask) + 1] += 1
        for k in range(mask + 1):
            counts[k + 1] += counts[k]
        for k in range(n):
            digit = (keys[k] >> shift) & mask
            to = counts[digit]
            counts[digit] = to + 1
            other_keys[to] = keys[k]
            other[to] = order[k]
        for k in range(n):
            keys[k] = other_keys[k]
            order[k] = other[k]


@inlined
def first_above(keys, low, high, bound):
    """The first of keys[low:high], sorted, that is not below the bound."""
    while low < high:
        middle = (low + high) // 2
        if keys[middle] < bound:
            low = middle + 1
        else:
            high = middle
    return low


@kernel(types.int64(A, N, K, N, N))
def build(floats, n, keys, at, most):
    """Build up to ``most`` nodes over n sorted bodies at floats[at:]; their number. Without room leaves grow."""
    levels = np.empty(most, dtype=np.int64)
    floats[at + BEGIN], floats[at + END] = 0.0, n
    levels[0] = DEEPEST
    count, node = 1, 0
    starts = np.empty(9, dtype=np.int64)
    while node < count:
        here = at + NODE * node
        begin, end = int(floats[here + BEGIN]), int(floats[here + END])
        floats[here + CHILDREN] = 0.0
        level = levels[node]
        # Descend to the first cell with several children: keys[begin] and keys[end - 1] differ there.
        while level > 0 and (keys[begin] >> (3 * level - 3)) == (keys[end - 1] >> (3 * level - 3)):
            level -= 1
        if end - begin > LEAF and level > 0 and count + 8 <= most:
            shift = 3 * level - 3
            base = (keys[begin] >> (shift + 3)) << 3
            floats[here + CHILD] = count
            starts[0], starts[8] = begin, end
            for octant in range(1, 8):
                starts[octant] = first_above(keys, starts[octant - 1], end, (base + octant) << shift)
            for octant in range(8):
                if starts[octant + 1] > starts[octant]:
                    child = at + NODE * count
                    floats[child + BEGIN], floats[child + END] = starts[octant], starts[octant + 1]
                    levels[count] = level - 1
                    count += 1
                    floats[here + CHILDREN] += 1.0
        node += 1
    return count


@inlined
def add_second(floats, here, m, dx, dy, dz):
    """The second moments of a mass m away from the center of mass."""
    floats[here + SXX] += 3.0 * m * dx * dx
    floats[here + SXY] += 3.0 * m * dx * dy
    floats[here + SXZ] += 3.0 * m * dx * dz
    floats[here + SYY] += 3.0 * m * dy * dy
    floats[here + SYZ] += 3.0 * m * dy * dz
    floats[here + SZZ] += 3.0 * m * dz * dz


@kernel(types.void(A, N, N, N, N, N), inner=True)
def moments(floats, count, at, places, room, masses):
    """Moments and radii of the nodes, from the last to the first; places and masses are sorted."""
    for node in range(count - 1, -1, -1):
        here = at + NODE * node
        leaf = floats[here + CHILDREN] == 0.0
        begin, end = int(floats[here + BEGIN]), int(floats[here + END])
        first = at + NODE * int(floats[here + CHILD])
        last = first + NODE * int(floats[here + CHILDREN])
        for c in range(X, RADIUS + 1):
            floats[here + c] = 0.0
        if leaf:
            for k in range(begin, end):
                m = floats[masses + k]
                floats[here + M] += m
                for c in range(3):
                    floats[here + c] += m * floats[places + c * room + k]
        else:
            for child in range(first, last, NODE):
                m = floats[child + M]
                floats[here + M] += m
                for c in range(3):
                    floats[here + c] += m * floats[child + c]
        for c in range(3):
            # Any point serves as the center of massless bodies.
            mean = floats[here + c] / floats[here + M] if floats[here + M] > 0.0 else floats[places + c * room + begin]
            floats[here + c] = mean
        x, y, z = floats[here], floats[here + 1], floats[here + 2]
        if leaf:
            for k in range(begin, end):
                dx = floats[places + k] - x
                dy = floats[places + room + k] - y
                dz = floats[places + 2 * room + k] - z
                add_second(floats, here, floats[masses + k], dx, dy, dz)
                floats[here + RADIUS] = max(floats[here + RADIUS], dx * dx + dy * dy + dz * dz)
            floats[here + RADIUS] = math.sqrt(floats[here + RADIUS])
        else:
            for child in range(first, last, NODE):
                for c in range(SXX, SZZ + 1):
                    floats[here + c] += floats[child + c]
                dx, dy, dz = floats[child] - x, floats[child + 1] - y, floats[child + 2] - z
                add_second(floats, here, floats[child + M], dx, dy, dz)
                away = math.sqrt(dx * dx + dy * dy + dz * dz) + floats[child + RADIUS]
                floats[here + RADIUS] = max(floats[here + RADIUS], away)
        floats[here + TRACE] = 0.5 * (floats[here + SXX] + floats[here + SYY] + floats[here + SZZ])


@kernel(types.int64(A, N, N, N))
def groups(floats, count, at, out):
    """First body of each group of at most GROUP neighbors in the tree, and the end, to floats[out:]; their number.

    Small siblings form one group. A leaf that stayed large for lack of nodes is split into several.
    """
    stack = np.empty(8 * (DEEPEST + 2) + count, dtype=np.int64)
    stack[0] = 0
    top, found, begin = 1, 0, 0
    floats[out] = 0.0
    while top > 0:
        top -= 1
        here = at + NODE * stack[top]
        first, last = int(floats[here + BEGIN]), int(floats[here + END])
        if last - begin <= GROUP:
            continue
        if first > begin:
            found += 1
            floats[out + found] = begin = first
        if last - first <= GROUP:
            continue
        children = int(floats[here + CHILDREN])
        if children == 0:
            while last - begin > GROUP:
                found += 1
                begin += GROUP
                floats[out + found] = begin
        for child in range(children - 1, -1, -1):
            stack[top] = int(floats[here + CHILD]) + child
            top += 1
    end = int(floats[at + END])
    if end > begin:
        found += 1
        floats[out + found] = end
    return found
