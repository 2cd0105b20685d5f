# mypy: ignore-errors
"""The cells around a point, and their weights in the linear interpolant between the centers of cells.

Cells outside the domain have weight 0; the other weights sum to 1, or all are 0.
"""

import math

from sceneql.compiled.kernels import lean_inlined

AT, NX, NY, NZ, VOLUMES_AT, BOX_AT, PERIODIC = range(7)
"""Integers of a field, from ``first`` on: volumes are 0 outside, a box is low corner and sides (6 floats), and the
three from PERIODIC on are 1 where it is periodic along x, y, z."""
CORNERS = 8


@lean_inlined
def moved(cell, axis, way, floats, ints, first):
    """The neighbor of a cell along an axis, periodic where the grid is; the cell itself where that is outside."""
    nx, ny, nz = ints[first + NX], ints[first + NY], ints[first + NZ]
    count = nx if axis == 0 else (ny if axis == 1 else nz)
    stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
    place = cell // stride % count
    found = cell + way * stride
    if place + way < 0 or place + way >= count:
        if ints[first + PERIODIC + axis] == 0:
            return cell
        found = cell - way * (count - 1) * stride
    return found if floats[ints[first + VOLUMES_AT] + found] > 0.0 else cell


@lean_inlined
def around(x, y, z, floats, ints, first, cells, weights):
    """Fill cells and weights (CORNERS,); False where the point lies more than half a cell outside the domain."""
    nx, ny, nz = ints[first + NX], ints[first + NY], ints[first + NZ]
    box, volumes = ints[first + BOX_AT], ints[first + VOLUMES_AT]
    total = 0.0
    for corner in range(CORNERS):
        weight = 1.0
        cell = 0
        for axis in range(3):
            count = nx if axis == 0 else (ny if axis == 1 else nz)
            stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
            high = corner >> axis & 1
            if count == 1:
                weight *= 1.0 - high
                continue
            place = x if axis == 0 else (y if axis == 1 else z)
            place = (place - floats[box + axis]) / floats[box + 3 + axis] - 0.5
            below = math.floor(place)
            weight *= place - below if high else 1.0 - (place - below)
            index = int(below) + high
            if ints[first + PERIODIC + axis] == 1:
                index %= count
            if index < 0 or index >= count:
                weight = 0.0
                index = 0
            cell += index * stride
        if floats[volumes + cell] == 0.0:
            weight = 0.0
        cells[corner] = cell
        weights[corner] = weight
        total += weight
    if total < 1e-9:
        return False
    for corner in range(CORNERS):
        weights[corner] /= total
    return True
