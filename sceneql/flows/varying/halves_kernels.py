# mypy: ignore-errors
"""Halves of cells (fluid_layout.py): how many, which of them make up a cell, and means over them."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.system.signatures_kernels import A, I, N


@lean_inlined
def halves(one):
    """Halves along x, y, z; one along z of a flat flow."""
    return 2 * one[flow.CELLS], 2 * one[flow.CELLS + 1], 2 * one[flow.CELLS + 2] if one[flow.AXES] == 3 else 1


@lean_inlined
def reach(place, count, on_face, periodic):
    """First half of two that a cell takes up, and how many of them are there: ``place`` is that of a cell of ``count``,
    or of the face on its low side, around which the cell then lies."""
    if not on_face:
        return 2 * place, 2
    if periodic:
        return (2 * place - 1) % (2 * count), 2
    if place == 0:
        return 0, 1
    return 2 * place - 1, 2 if place < count else 1


@lean_inlined
def mean_row(values, y0, yn, z0, zn, line, one):
    """Into ``line`` the mean of rows of halves: of yn from y0 on along y, of zn from z0 on along z."""
    nx, ny, nz = halves(one)
    part = 1.0 / (yn * zn)
    first, second = nx * (y0 % ny + ny * (z0 % nz)), nx * ((y0 + yn - 1) % ny + ny * (z0 % nz))
    third, fourth = nx * (y0 % ny + ny * ((z0 + 1) % nz)), nx * ((y0 + yn - 1) % ny + ny * ((z0 + 1) % nz))
    a, b, c, d = values[first:], values[second:], values[third:], values[fourth:]
    if yn == 2 and zn == 2:
        for i in range(nx):
            line[i] = part * ((a[i] + b[i]) + (c[i] + d[i]))
    elif yn == 2 or zn == 2:
        more = b if yn == 2 else c
        for i in range(nx):
            line[i] = part * (a[i] + more[i])
    else:
        for i in range(nx):
            line[i] = a[i]


@lean(types.void(A, N, N, N, N, A, I), inner=True)
def row_of(values, j, k, a, b, line, one):
    """Into ``line`` (halves along x) the mean, over halves along y and z, of a row of cells.

    Those around the centers in row (j, k) (a, b: -1), around faces of component a, or around edges of a and b.
    """
    y0, yn = reach(j, one[flow.CELLS + 1], a == 1 or b == 1, one[flow.PERIODIC + 1] == 1)
    z0, zn = 0, 1
    if one[flow.AXES] == 3:
        z0, zn = reach(k, one[flow.CELLS + 2], a == 2 or b == 2, one[flow.PERIODIC + 2] == 1)
    mean_row(values, y0, yn, z0, zn, line, one)


@lean_inlined
def across_x(j, k, a, b, side, one):
    """First halves and how many, along y and z, of the cell of a face of component a; along b half ``side`` alone."""
    y0, yn = (side, 1) if b == 1 else reach(j, one[flow.CELLS + 1], a == 1, one[flow.PERIODIC + 1] == 1)
    z0, zn = 0, 1
    if b == 2:
        z0 = side
    elif one[flow.AXES] == 3:
        z0, zn = reach(k, one[flow.CELLS + 2], a == 2, one[flow.PERIODIC + 2] == 1)
    return y0, yn, z0, zn


@lean(types.void(A, N, N, N, N, N, A, I), inner=True)
def layer_of(values, j, k, a, b, side, line, one):
    """As `row_of`, of half ``side`` alone of those along the axis b = 1 or 2, across which the cells lie at faces."""
    y0, yn, z0, zn = across_x(j, k, a, b, side, one)
    mean_row(values, y0, yn, z0, zn, line, one)


@lean_inlined
def pairs(line, on_face, one, out):
    """Of a row of halves the mean in each cell, or with ``on_face`` in the cell around each face, of which those at an
    end of the box have one half; how many."""
    n = one[flow.CELLS]
    if not on_face:
        for i in range(n):
            out[i] = 0.5 * (line[2 * i] + line[2 * i + 1])
        return n
    for i in range(1, n):
        out[i] = 0.5 * (line[2 * i - 1] + line[2 * i])
    if one[flow.PERIODIC] == 1:
        out[0] = 0.5 * (line[2 * n - 1] + line[0])
        return n
    out[0], out[n] = line[0], line[2 * n - 1]
    return n + 1


@lean(types.float64(A, N, N, N, N, N, N, I), inner=True)
def at_wall(values, i, j, k, a, b, side, one):
    """The mean over half ``side`` alone of those along the axis b, of the cell of a face of component a."""
    nx, ny, nz = halves(one)
    x0, xn = (side, 1) if b == 0 else reach(i, one[flow.CELLS], a == 0, one[flow.PERIODIC] == 1)
    y0, yn, z0, zn = across_x(j, k, a, b, side, one)
    found = 0.0
    for c in range(zn):
        for d in range(yn):
            row = nx * ((y0 + d) % ny + ny * ((z0 + c) % nz))
            for e in range(xn):
                found += values[row + (x0 + e) % nx]
    return found / (xn * yn * zn)
