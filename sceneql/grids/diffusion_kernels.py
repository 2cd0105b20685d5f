# mypy: ignore-errors
"""The rate of a field on a grid: fluxes through faces, exchange with the boundary, and sources.

Arrays in ``floats`` have one number per cell, (cells,), at the offsets in ``ints``; a face is stored with the cell on
its high side (system.Grid).
"""

import math

from sceneql.compiled.kernels import lean
from sceneql.grids.multigrid.stencil_kernels import flow
from sceneql.system.signatures_kernels import TERM

AT, NX, NY, NZ, VOLUMES, SINK, FED, GX, GY, GZ, INFLOW = range(11)
"""Integers of `spread`: the first cell in y, ..., and the entry of the inflow."""
COEFFICIENTS, FACES, TIES, SINKS, OWNERS, AREAS, DISTANCES, RESISTANCES, WEIGHTS, OWNERS_AT = 0, 4, 7, *range(10, 17)
"""Integers of `conduct`, around NX, NY, NZ: conductances along x, y, z, and area/distance likewise; the number of
boundary faces, and from OWNERS_AT on the cell of each."""
CELLS, BASE, TARGET = range(3)
"""Integers of `begin`."""


@lean(TERM, inner=True)
def spread(t, y, rate, floats, ints):
    """V dc/dt = sum of g (neighbor - c) + fed - sink c; the last two, summed over all cells, are the inflow."""
    at, nx, ny, nz = ints[AT], ints[NX], ints[NY], ints[NZ]
    n = nx * ny * nz
    volume, sink = floats[ints[VOLUMES] : ints[VOLUMES] + n], floats[ints[SINK] : ints[SINK] + n]
    fed, x = floats[ints[FED] : ints[FED] + n], y[at : at + n]
    gx, gy = floats[ints[GX] : ints[GX] + n], floats[ints[GY] : ints[GY] + n]
    gz = floats[ints[GZ] : ints[GZ] + (n if nz > 1 else 0)]
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
    rate[ints[INFLOW]] += inflow


@lean(TERM, inner=True)
def conduct(t, y, rate, floats, ints):
    """Conductances, boundary exchange and its weights from the coefficients of cells, which vary.

    A face has the mean of its cells' coefficients times area/distance; a boundary face of resistance r, in series with
    the distance from the cell's center, the weight A D / (D r + distance).
    """
    d, nx, ny, nz = ints[COEFFICIENTS], ints[NX], ints[NY], ints[NZ]
    plane = nx * ny
    n = plane * nz
    for c in range(n):
        if not floats[d + c] >= 0.0:
            floats[d + c] = math.nan
        floats[ints[SINKS] + c] = 0.0
    for c in range(n):
        i, j, k = c % nx, c // nx % ny, c // plane
        left = c - 1 if i > 0 else c + nx - 1
        below = c - nx if j > 0 else c + plane - nx
        floats[ints[FACES] + c] = floats[ints[TIES] + c] * 0.5 * (floats[d + c] + floats[d + left])
        floats[ints[FACES + 1] + c] = floats[ints[TIES + 1] + c] * 0.5 * (floats[d + c] + floats[d + below])
        if nz > 1:
            back = c - plane if k > 0 else c + n - plane
            floats[ints[FACES + 2] + c] = floats[ints[TIES + 2] + c] * 0.5 * (floats[d + c] + floats[d + back])
    for k in range(ints[OWNERS]):
        cell = ints[OWNERS_AT + k]
        own = floats[d + cell]
        if floats[ints[RESISTANCES] + k] < 0.0:
            continue  # a given flux
        weight = floats[ints[AREAS] + k] * own / (own * floats[ints[RESISTANCES] + k] + floats[ints[DISTANCES] + k])
        floats[ints[WEIGHTS] + k] = weight
        floats[ints[SINKS] + cell] += weight


@lean(TERM, inner=True)
def begin(t, y, rate, floats, ints):
    """Set the sources to their constant part, before varying ones are added."""
    for c in range(ints[CELLS]):
        floats[ints[TARGET] + c] = floats[ints[BASE] + c]
