# mypy: ignore-errors
"""The rate of a field on a grid: fluxes through faces, exchange with the boundary, and what is fed.

Arrays in ``floats`` have one number a cell, (cells,), at the offsets in ``ints``; a face stands with the cell on its
high side (system.Grid).
"""

import math

from sceneql.compiled.kernels import lean
from sceneql.grids.multigrid.stencil_kernels import flow
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def spread(t, y, rate, floats, ints):
    """V dc/dt = sum of g (neighbor - c) + fed - sink c; the last two, summed over all cells, are what comes in.

    ints: at, nx, ny, nz, volumes, sink, fed, gx, gy, gz, entry of the inflow.
    """
    at, nx, ny, nz = ints[0], ints[1], ints[2], ints[3]
    n = nx * ny * nz
    volume, sink = floats[ints[4] : ints[4] + n], floats[ints[5] : ints[5] + n]
    fed, x = floats[ints[6] : ints[6] + n], y[at : at + n]
    gx, gy = floats[ints[7] : ints[7] + n], floats[ints[8] : ints[8] + n]
    gz = floats[ints[9] : ints[9] + (n if nz > 1 else 0)]
    deep, plane = nz > 1, nx * ny
    inflow = 0.0
    own = rate[at : at + n]
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            last = row + nx - 1
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            for c in range(row + 1, last):
                total = flow(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
                own[c] += (total + fed[c] - sink[c] * x[c]) / volume[c]
            for c in range(row, last + 1, max(1, nx - 1)):
                left, right = (last if c == row else c - 1), (row if c == last else c + 1)
                total = flow(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
                own[c] += (total + fed[c] - sink[c] * x[c]) / volume[c]
            for c in range(row, last + 1):
                inflow += fed[c] - sink[c] * x[c]
    rate[ints[10]] += inflow


@lean(TERM, inner=True)
def conduct(t, y, rate, floats, ints):
    """Conductances, boundary exchange and its weights from the coefficients of cells, which vary.

    A face has the mean of its cells' coefficients times area/distance; a boundary face, through the way to it and its
    own resistance r, the weight A D / (D r + distance). ints: coefficients, nx, ny, nz, gx, gy, gz, the same of
    area/distance, sink, then the boundary: its count, cells (in ints from the end of this head on), areas, distances,
    resistances, weights.
    """
    d, nx, ny, nz = ints[0], ints[1], ints[2], ints[3]
    plane = nx * ny
    n = plane * nz
    for c in range(n):
        if not floats[d + c] >= 0.0:
            floats[d + c] = math.nan
        floats[ints[10] + c] = 0.0
    for c in range(n):
        i, j, k = c % nx, c // nx % ny, c // plane
        left = c - 1 if i > 0 else c + nx - 1
        below = c - nx if j > 0 else c + plane - nx
        floats[ints[4] + c] = floats[ints[7] + c] * 0.5 * (floats[d + c] + floats[d + left])
        floats[ints[5] + c] = floats[ints[8] + c] * 0.5 * (floats[d + c] + floats[d + below])
        if nz > 1:
            back = c - plane if k > 0 else c + n - plane
            floats[ints[6] + c] = floats[ints[9] + c] * 0.5 * (floats[d + c] + floats[d + back])
    for k in range(ints[11]):
        cell = ints[16 + k]
        own = floats[d + cell]
        if floats[ints[14] + k] < 0.0:
            continue  # a given flux
        weight = floats[ints[12] + k] * own / (own * floats[ints[14] + k] + floats[ints[13] + k])
        floats[ints[15] + k] = weight
        floats[ints[10] + cell] += weight


@lean(TERM, inner=True)
def begin(t, y, rate, floats, ints):
    """What is fed, before what varies is added: floats[ints[2] + c] = floats[ints[1] + c], c below ints[0]."""
    for c in range(ints[0]):
        floats[ints[2] + c] = floats[ints[1] + c]
