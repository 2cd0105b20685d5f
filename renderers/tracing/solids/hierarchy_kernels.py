# mypy: ignore-errors
"""A bounding volume hierarchy by the surface area heuristic, binned (Wald 2007), as a list with skip links."""

import numpy as np
from numba import types

from renderers.tracing.scene_kernels import part
from sceneql.compiled.kernels import kernel

LEAF = 4
"""Items above which a node is always split."""
BINS = 16

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
        clear_bins(bins, BINS + 1)
        for i in range(start, stop):
            b = bin_of(boxes, order[i], axis, low, scale)
            grow(bins, b, boxes, order[i])
            bins[b, 6] += 1.0
        for b in range(BINS - 1, 0, -1):  # costs of all to the right, gathered in row BINS
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
def divide(boxes, order, start, stop, axis, bin, eye):
    """Part the items behind ``bin`` from the others, those on the eye's side to the front; where they end."""
    low, high = np.inf, -np.inf
    for i in range(start, stop):
        middle = boxes[order[i], axis] + boxes[order[i], 3 + axis]
        low = min(low, middle)
        high = max(high, middle)
    scale = BINS / (high - low)
    upper = 2.0 * eye[axis] > low + (bin + 1) / scale
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
    ),
    _nrt=False,
)
def build(boxes, order, eye, nodes, links, stack, bins, right, first_at):
    """Number of nodes written for items with bounds ``boxes`` (m, 6); ``order`` (m,) becomes the order by leaf.

    Nodes stand in depth-first order, the child on the side of ``eye`` first, so that a walk without a stack meets near
    things early. ``nodes`` (2m, 6) and ``links`` (2m, 3) as in Scene; ``stack`` (2m + 2, 2), ``bins`` (BINS + 1, 7),
    ``right`` (BINS + 1,) and ``first_at`` (m + 1,) are working memory.
    """
    count = len(order)
    n = 0
    top = 0
    if count:
        stack[0, 0], stack[0, 1] = 0, count
        top = 1
    while top:
        top -= 1
        start, stop = stack[top, 0], stack[top, 1]
        clear_bins(bins, 1)
        for i in range(start, stop):
            grow(bins, 0, boxes, order[i])
        for column in range(6):
            nodes[n, column] = bins[0, column]
        area = half_area(bins, 0)
        links[n, 0] = stop  # the end of its items for now
        links[n, 1] = start
        links[n, 2] = 0
        n += 1
        axis, bin, cost = -1, 0, np.inf
        if stop - start > 1:
            axis, bin, cost = best_split(boxes, order, start, stop, bins, right)
        if axis < 0 or (stop - start <= LEAF and cost + area >= area * (stop - start)):
            links[n - 1, 2] = stop - start
            continue
        middle = divide(boxes, order, start, stop, axis, bin, eye)
        stack[top, 0], stack[top, 1] = middle, stop
        stack[top + 1, 0], stack[top + 1, 1] = start, middle
        top += 2
    first_at[count] = n
    for k in range(n - 1, -1, -1):
        links[k, 0] = first_at[links[k, 0]]
        first_at[links[k, 1]] = k
    return n
