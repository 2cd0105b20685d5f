# mypy: ignore-errors
"""Cell lists: points sorted by the cell that they stand in (Hockney & Eastwood 1981, section 8.4)."""

import math

import numpy as np

from sceneql.compiled.kernels import inlined


@inlined
def cell_of(x, edge):
    """Number of the cell along one axis, of any size within 2^53."""
    return math.floor(x / edge)


@inlined
def sort_by_cell(floats, n, points, edge, size, p, q, sorted_at, order_at, start_at):
    """Sort the points with a finite x by cell. All arguments of places are offsets into floats.

    ``points``: all x, y, z (3 n); written are ``sorted_at`` (3 n) the same in order of cells, ``order_at`` (n) the
    number of each, ``start_at`` (size + 1) the first of each place of the table (neighbors.table) and their number.
    """
    mask = size - 1
    place = np.empty(n, dtype=np.int64)
    start = np.zeros(size + 1, dtype=np.int64)
    for k in range(n):
        if not math.isfinite(floats[points + k]):
            continue
        i = cell_of(floats[points + k], edge)
        j = cell_of(floats[points + n + k], edge)
        l = cell_of(floats[points + 2 * n + k], edge)
        place[k] = (i + p * j + q * l) & mask
        start[place[k] + 1] += 1
    for k in range(size):
        start[k + 1] += start[k]
    for k in range(size + 1):
        floats[start_at + k] = start[k]
    for k in range(n):
        if not math.isfinite(floats[points + k]):
            continue
        to = start[place[k]]
        start[place[k]] += 1
        floats[order_at + to] = k
        for c in range(3):
            floats[sorted_at + c * n + to] = floats[points + c * n + k]
