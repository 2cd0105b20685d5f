# mypy: ignore-errors
"""Boxes in a binary tree, halved at the median along the longest side of their middles, as a list with skip links."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined

SKIP, FIRST, HELD = range(3)
"""Columns of a node: the next one outside it in depth-first order, its first item, and how many (0: no leaf)."""
ROWS = types.float64[:, ::1]
NODES = types.int64[:, ::1]


@lean_inlined
def middle(boxes, k, axis):
    """Twice the middle of a box along an axis."""
    return boxes[k, axis] + boxes[k, axis + 3]


@lean_inlined
def halve(boxes, order, axis, first, last, half):
    """Reorder items first..last-1: none before ``half`` lies above one behind (Hoare 1961, FIND)."""
    low, high = first, last - 1
    while low < high:
        pivot = middle(boxes, order[(low + high) // 2], axis)
        i, j = low, high
        while i <= j:
            while middle(boxes, order[i], axis) < pivot:
                i += 1
            while middle(boxes, order[j], axis) > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if half <= j:
            high = j
        elif half >= i:
            low = i
        else:
            return


@lean(types.int64(ROWS, types.int64[::1], ROWS, NODES, NODES, types.int64))
def grow(boxes, order, nodes, links, stack, leaf):
    """Number of nodes written for items with bounds ``boxes`` (m, 6); ``order`` (m,) becomes the order by leaf.

    ``nodes`` (2m, 6) get low and high corners, ``links`` (2m, 3) the columns above; a leaf holds at most ``leaf``.
    ``stack`` (130, 3) is working memory: twice the depth of 64 bits.
    """
    count, top = 0, 1
    stack[0, 0], stack[0, 1], stack[0, 2] = 0, len(order), -1
    while top > 0:
        top -= 1
        first, last, closes = stack[top, 0], stack[top, 1], stack[top, 2]
        if closes >= 0:  # all nodes inside this one have been laid out
            links[closes, SKIP] = count
            continue
        node = count
        count += 1
        axis, longest = 0, -1.0
        for k in range(3):
            low, high = boxes[order[first], k], boxes[order[first], k + 3]
            least = most = middle(boxes, order[first], k)
            for i in range(first + 1, last):
                item = order[i]
                low, high = min(low, boxes[item, k]), max(high, boxes[item, k + 3])
                at = middle(boxes, item, k)
                least, most = min(least, at), max(most, at)
            nodes[node, k], nodes[node, k + 3] = low, high
            if most - least > longest:
                axis, longest = k, most - least
        links[node, SKIP], links[node, FIRST], links[node, HELD] = count, first, last - first
        if last - first <= leaf:
            continue
        links[node, HELD] = 0
        half = first + (last - first) // 2
        halve(boxes, order, axis, first, last, half)
        stack[top, 2] = node
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = half, last, -1
        stack[top + 2, 0], stack[top + 2, 1], stack[top + 2, 2] = first, half, -1
        top += 3
    return count
