# mypy: ignore-errors
"""Poisson disk samples: points with a minimum distance from each other."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel

PLACES = types.float64[:, ::1]


@inlined
def cell_of(place, low, side):
    """Whole numbers of the cell of a place."""
    return int((place[0] - low[0]) / side), int((place[1] - low[1]) / side), int((place[2] - low[2]) / side)


@kernel(types.int64(PLACES, PLACES, types.int64, types.float64[::1], types.float64[::1], types.float64))
def spread(darts, places, kept, low, room, apart):
    """Append darts (n, 3) at least ``apart`` from all the ``kept`` first of ``places``; return the new number.

    Neighbors are found by cells of side ``apart``, each a linked list; ``places`` is never overfilled.
    """
    side = max(apart, 1e-9 + np.cbrt(room[0] * room[1] * room[2] / 2e7))
    nx, ny, nz = int(room[0] / side) + 1, int(room[1] / side) + 1, int(room[2] / side) + 1
    heads = np.full(nx * ny * nz, -1, np.int64)
    after = np.full(len(places), -1, np.int64)
    for k in range(kept):
        i, j, l = cell_of(places[k], low, side)
        after[k] = heads[(i * ny + j) * nz + l]
        heads[(i * ny + j) * nz + l] = k
    for dart in darts:
        if kept == len(places):
            break
        i, j, l = cell_of(dart, low, side)
        free = True
        for a in range(max(i - 1, 0), min(i + 2, nx)):
            for b in range(max(j - 1, 0), min(j + 2, ny)):
                for c in range(max(l - 1, 0), min(l + 2, nz)):
                    other = heads[(a * ny + b) * nz + c]
                    while other >= 0 and free:
                        dx = places[other, 0] - dart[0]
                        dy = places[other, 1] - dart[1]
                        dz = places[other, 2] - dart[2]
                        free = dx * dx + dy * dy + dz * dz >= apart * apart
                        other = after[other]
        if free:
            places[kept] = dart
            after[kept] = heads[(i * ny + j) * nz + l]
            heads[(i * ny + j) * nz + l] = kept
            kept += 1
    return kept
