# mypy: ignore-errors
"""A bounding volume hierarchy by the surface area heuristic, binned (Wald 2007), as a list with skip links."""

import numpy as np
from numba import types

from renderers.tracing.scene_kernels import part
from sceneql.compiled.kernels import kernel

LEAF = 4
"""Items above which a node is always split."""
BINS = 16
BOX, AXIS, BIN, LOW, SCALE, CHILD, SPLIT_SIZE = 0, 6, 7, 8, 9, 10, 11
"""Columns of a node's split: its box; axis (-1: a leaf), last bin of the lower side, lowest middle of its items
(twice), bins per length; row of the lower child, followed by the upper one. The eye does not change the splits, only
the order of children."""

_rows = types.float64[:, ::1]


@part
def half_area(bins, b):
    """Half the surface of the box in row b of bins (BINS, 7)."""
    x = bins[b, 3] - bins[b, 0]
    y = bins[b, 4] - bins[b, 1]
    z = bins[b, 5] - bins[b, 2]
    return x * y + y * z + z * x


@part
def grow(bins, b, boxes, k):
    """Let the box in row b hold the box in row k of boxes."""
    for axis in range(3):
        bins[b, axis] = min(bins[b, axis], boxes[k, axis])
        bins[b, 3 + axis] = max(bins[b, 3 + axis], boxes[k, 3 + axis])


@part
def clear_bins(bins, rows):
    """Make rows of bins empty boxes with no item."""
    for b in range(rows):
        for axis in range(3):
            bins[b, axis] = np.inf
            bins[b, 3 + axis] = -np.inf
        bins[b, 6] = 0.0


@part
def bin_of(boxes, k, axis, low, scale):
    """Bin of an item by the middle of its box."""
    return min(int((boxes[k, axis] + boxes[k, 3 + axis] - low) * scale), BINS - 1)


@part
def best_split(boxes, order, start, stop, bins, right):
    """(axis, bin, cost) of the cheapest split: items up to the bin go left; axis -1 where there is none."""
    axis_found, bin_found, least = -1, 0, np.inf
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in range(start, stop):
            middle = boxes[order[i], axis] + boxes[order[i], 3 + axis]
            low = min(low, middle)
            high = max(high, middle)
        if not high > low:
            continue
        scale = BINS / (high - low)
        if not 0.0 < scale < np.inf:  # middles too near to each other, or too far apart, for bins
            continue
        clear_bins(bins, BINS + 1)
        for i in range(start, stop):
            b = bin_of(boxes, order[i], axis, low, scale)
            grow(bins, b, boxes, order[i])
            bins[b, 6] += 1.0
        for b in range(BINS - 1, 0, -1):  # costs of the upper sides, accumulated in row BINS
            grow(bins, BINS, bins, b)
            bins[BINS, 6] += bins[b, 6]
            right[b] = half_area(bins, BINS) * bins[BINS, 6] if bins[BINS, 6] > 0.0 else 0.0
        clear_bins(bins[BINS:], 1)
        for b in range(BINS - 1):
            grow(bins, BINS, bins, b)
            bins[BINS, 6] += bins[b, 6]
            if bins[BINS, 6] == 0.0 or bins[BINS, 6] == stop - start:
                continue
            cost = half_area(bins, BINS) * bins[BINS, 6] + right[b + 1]
            if cost < least:
                axis_found, bin_found, least = axis, b, cost
    return axis_found, bin_found, least


@part
def bins_along(boxes, order, start, stop, axis):
    """(low, scale) of the bins of some items along an axis."""
    low, high = np.inf, -np.inf
    for i in range(start, stop):
        middle = boxes[order[i], axis] + boxes[order[i], 3 + axis]
        low = min(low, middle)
        high = max(high, middle)
    return low, BINS / (high - low)


@part
def on_the_upper_side(axis, bin, low, scale, eye):
    """Whether the eye is on the upper side of a split."""
    return 2.0 * eye[axis] > low + (bin + 1) / scale


@part
def divide(boxes, order, start, stop, axis, bin, low, scale, upper):
    """Partition items by a split at ``bin``, those on the side ``upper`` first; returns where they end."""
    end = start
    for i in range(start, stop):
        if (bin_of(boxes, order[i], axis, low, scale) > bin) == upper:
            order[end], order[i] = order[i], order[end]
            end += 1
    return end


@kernel(
    types.int64(
        _rows,
        types.int64[::1],
        types.float64[::1],
        _rows,
        types.int32[:, ::1],
        types.int64[:, ::1],
        _rows,
        types.float64[::1],
        types.int64[::1],
        _rows,
        types.boolean,
    ),
    _nrt=False,
)
def build(boxes, order, eye, nodes, links, stack, bins, right, first_at, splits, known):
    """Number of nodes written for items with bounds ``boxes`` (m, 6); ``order`` (m,) becomes the order by leaf.

    Nodes stand in depth-first order, the child on the side of ``eye`` first, so that a walk without a stack meets near
    items early. ``nodes`` (2m, 6) and ``links`` (2m, 3) as in Scene; ``stack`` (2m + 2, 3), ``bins`` (BINS + 1, 7),
    ``right`` (BINS + 1,) and ``first_at`` (m + 1,) are working memory. ``splits`` (2m, SPLIT_SIZE), unless it has no
    rows, is filled with the nodes' splits; if they are ``known`` they are read from it instead of searched.
    """
    count = len(order)
    n = 0
    top = 0
    rows = 1
    if count:
        stack[0, 0], stack[0, 1], stack[0, 2] = 0, count, 0
        top = 1
    while top:
        top -= 1
        start, stop, row = stack[top, 0], stack[top, 1], stack[top, 2]
        links[n, 0] = stop  # the end of its items for now
        links[n, 1] = start
        links[n, 2] = 0
        n += 1
        axis, bin, low, scale = -1, 0, 0.0, 0.0
        if known:
            for column in range(6):
                nodes[n - 1, column] = splits[row, BOX + column]
            axis, bin = int(splits[row, AXIS]), int(splits[row, BIN])
            low, scale = splits[row, LOW], splits[row, SCALE]
        else:
            clear_bins(bins, 1)
            for i in range(start, stop):
                grow(bins, 0, boxes, order[i])
            for column in range(6):
                nodes[n - 1, column] = bins[0, column]
            area = half_area(bins, 0)
            if stop - start > 1:
                axis, bin, cost = best_split(boxes, order, start, stop, bins, right)
                if axis >= 0 and stop - start <= LEAF and cost + area >= area * (stop - start):
                    axis = -1
            if axis >= 0:
                low, scale = bins_along(boxes, order, start, stop, axis)
        child = rows
        if known:
            child = int(splits[row, CHILD])
        elif len(splits):
            for column in range(6):
                splits[row, BOX + column] = nodes[n - 1, column]
            splits[row, AXIS], splits[row, BIN] = axis, bin
            splits[row, LOW], splits[row, SCALE], splits[row, CHILD] = low, scale, child
        if axis < 0:
            links[n - 1, 2] = stop - start
            continue
        rows += 2
        upper = on_the_upper_side(axis, bin, low, scale, eye)
        middle = divide(boxes, order, start, stop, axis, bin, low, scale, upper)
        near, far = (child + 1, child) if upper else (child, child + 1)
        stack[top, 0], stack[top, 1], stack[top, 2] = middle, stop, far
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = start, middle, near
        top += 2
    first_at[count] = n
    for k in range(n - 1, -1, -1):
        links[k, 0] = first_at[links[k, 0]]
        first_at[links[k, 1]] = k
    return n
