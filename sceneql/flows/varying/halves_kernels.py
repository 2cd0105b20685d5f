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


@lean(types.float64(A, N, N, N, N, N, N, I), inner=True)
def total(values, i, j, k, a, b, side, one):
    """The sum over halves of the cell around a center (a, b: -1), a face of component a, or an edge of a and b.

    ``side``: -1, or half ``side`` alone of those along the axis b, on which the cell lies at faces.
    """
    nx, ny, nz = halves(one)
    periodic_x, periodic_y, periodic_z = (
        one[flow.PERIODIC] == 1,
        one[flow.PERIODIC + 1] == 1,
        one[flow.PERIODIC + 2] == 1,
    )
    x0, xn = reach(i, one[flow.CELLS], a == 0 or b == 0, periodic_x)
    y0, yn = reach(j, one[flow.CELLS + 1], a == 1 or b == 1, periodic_y)
    z0, zn = 0, 1
    if one[flow.AXES] == 3:
        z0, zn = reach(k, one[flow.CELLS + 2], a == 2 or b == 2, periodic_z)
    if side >= 0:
        if b == 0:
            x0, xn = min(side, nx - 1), 1
        elif b == 1:
            y0, yn = min(side, ny - 1), 1
        else:
            z0, zn = min(side, nz - 1), 1
    found = 0.0
    for c in range(zn):
        for d in range(yn):
            row = nx * ((y0 + d) % ny + ny * ((z0 + c) % nz))
            for e in range(xn):
                found += values[row + (x0 + e) % nx]
    return found


@lean(types.float64(A, N, N, N, N, N, N, I), inner=True)
def mean(values, i, j, k, a, b, side, one):
    """`total` over how many halves it is of."""
    count = 1.0
    places = (i, j, k)
    for axis in range(one[flow.AXES]):
        _, number = reach(places[axis], one[flow.CELLS + axis], a == axis or b == axis, one[flow.PERIODIC + axis] == 1)
        count *= 1 if side >= 0 and b == axis else number
    return total(values, i, j, k, a, b, side, one) / count
