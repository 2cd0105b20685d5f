# mypy: ignore-errors
"""The passes of a multistep method over a flow, each of which does all it can to a band of rows that the cache holds:
on large grids a step takes as long as its numbers take from memory and back."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.layout import AREAS, AT, AXES, BOTH, CELLS, FACES, PERIODIC, SCALES, SPECTRUM, VELOCITY
from sceneql.flows.lines_kernels import rows_down, rows_up
from sceneql.flows.near_solids_kernels import by_lines
from sceneql.flows.projection_kernels import first_face, lessen_row, outflow_row, pushed_at, rows_of_box
from sceneql.system.signatures_kernels import A, F, I

BAND = 4096
"""Cells of a band."""


@lean_inlined
def rows_of_band(ints):
    """Rows of cells in a band: as many as are transformed side by side, or some times that."""
    return BOTH * max(1, BAND // (BOTH * ints[CELLS]))


@lean_inlined
def by_bands(ints):
    """Whether bands are transformed along x one by one, which in layers of few rows would leave lanes empty."""
    return ints[CELLS + 2] == 1 or ints[CELLS + 1] % BOTH == 0


@lean_inlined
def piece(number, first, last, k, ints):
    """(first, number) of the faces of component ``number`` on the low sides of the cells of rows from ``first`` to
    before ``last`` of layer k, with those at the high end of the box; the number AXES means those along z there."""
    axis, nx, ny = min(number, ints[AXES] - 1), ints[CELLS], ints[CELLS + 1]
    start, up = first_face(axis, first, k, ints)
    more = 1 if axis == 1 and last == ny and ints[PERIODIC + 1] == 0 else 0
    wide = nx + 1 if axis == 0 and ints[PERIODIC] == 0 else nx
    if number == axis:
        return start, wide * (last - first + more)
    ends = axis == 2 and k == ints[CELLS + 2] - 1 and ints[PERIODIC + 2] == 0
    return start + up, (wide * (last - first) if ends else 0)


@lean_inlined
def combined(y1, y0, before, latest, n_before, factors, count):
    """The known part of a row's right side."""
    first, second, new, former = factors
    for k in range(count):
        y1[k] = first * y0[k] + second * before[k] + new * latest[k] + former * n_before[k]


@lean(types.void(A, A, A, A, A, types.UniTuple(F, 4), A, F, A, I), inner=True)
def explicit(y1, y0, before, latest, n_before, factors, pressure, part, floats, ints):
    """y1 = the sum of four states, less part times the gradient of the pressure."""
    at, faces, ny = ints[AT], ints[FACES], ints[CELLS + 1]
    u, scales = y1[at : at + faces], floats[ints[SCALES] : ints[SCALES] + faces]
    combined(y1, y0, before, latest, n_before, factors, at)
    end = at + faces
    combined(y1[end:], y0[end:], before[end:], latest[end:], n_before[end:], factors, y0.size - end)
    rows = rows_of_band(ints)
    for k in range(ints[CELLS + 2]):
        for j in range(0, ny, rows):
            last = min(ny, j + rows)
            for number in range(ints[AXES] + 1):
                begin, count = piece(number, j, last, k, ints)
                begin += at
                combined(y1[begin:], y0[begin:], before[begin:], latest[begin:], n_before[begin:], factors, count)
            if part != 0.0:
                for row in range(j, last):
                    lessen_row(u, scales, pressure, part, row, k, ints)


@lean(types.void(A, A, A, A, I), inner=True)
def gather(y1, gathered, q, floats, ints):
    """What flows out of cells; and in, as modes along x, in q, which becomes the pressure."""
    nx, ny, faces = ints[CELLS], ints[CELLS + 1], ints[FACES]
    u, areas = y1[ints[AT] : ints[AT] + faces], floats[ints[AREAS] : ints[AREAS] + faces]
    pushed, rows = pushed_at(VELOCITY, ints), rows_of_band(ints)
    for k in range(ints[CELLS + 2]):
        for first in range(0, ny, rows):
            last = min(ny, first + rows)
            for j in range(first, last):
                row = nx * (j + ny * k)
                own, less = gathered[row : row + nx], q[row : row + nx]
                outflow_row(u, areas, own, j, k, ints)
                if pushed >= 0:
                    for i in range(nx):
                        own[i] -= floats[pushed + row + i]
                for i in range(nx):
                    less[i] = -own[i]
            if by_bands(ints):
                rows_of_box(q, first + ny * k, last - first, True, floats, ints)
            if by_lines(ints):
                rows_up(q, nx, ny, first, last, 0, ny, floats[ints[SPECTRUM] :])
    if not by_bands(ints):
        rows_of_box(q, 0, ny * ints[CELLS + 2], True, floats, ints)


@lean_inlined
def part_of_band(u, y1, end, q, scales, first, last, k, ints):
    """Take the gradient of q from the velocities u of y1 in some rows, which are then remembered."""
    at = ints[AT]
    for row in range(first, last):
        lessen_row(u, scales, q, 1.0, row, k, ints)
    for number in range(ints[AXES] + 1):
        begin, count = piece(number, first, last, k, ints)
        for f in range(at + begin, at + begin + count):
            end[f] = y1[f]


@lean(types.void(A, A, A, A, A, A, F, F, A, I), inner=True)
def finish(y1, end, q, gathered, pressure, pressure_after, part, damped, floats, ints):
    """Take the gradient of q, of which modes along x are given, from y1, which is then remembered in ``end``, and put
    the pressure forward."""
    at, faces, nx, ny, nz = ints[AT], ints[FACES], ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    u, scales = y1[at : at + faces], floats[ints[SCALES] : ints[SCALES] + faces]
    for c in range(at):
        end[c] = y1[c]
    for c in range(at + faces, y1.size):
        end[c] = y1[c]
    rows = rows_of_band(ints)
    if by_lines(ints):  # from the last row to the first
        for number in range((ny + rows - 1) // rows):
            last = ny - number * rows
            first = max(0, last - rows)
            rows_down(q, nx, ny, first, last, 0, floats[ints[SPECTRUM] :])
            rows_of_box(q, first, last - first, False, floats, ints)
            # The lowest row needs the one below it.
            low, high = first + 1 if first > 0 else 0, last if last == ny else last + 1
            part_of_band(u, y1, end, q, scales, low, high, 0, ints)
            for c in range(nx * first, nx * last):
                pressure_after[c] = pressure[c] + (q[c] * part - damped * gathered[c])
        return
    known = nz if by_bands(ints) else 0  # layers whose rows stand for themselves
    if nz > 1 and ints[PERIODIC + 2] == 1:  # the first layer needs the last
        known = min(known, nz - 1)
    if known < nz:
        rows_of_box(q, ny * known, ny * (nz - known), False, floats, ints)
    for k in range(nz):
        whole = k >= known
        far = (ny - 1) // rows * rows
        if ints[PERIODIC + 1] == 1 and far > 0 and not whole:  # the first row needs the last
            rows_of_box(q, far + ny * k, ny - far, False, floats, ints)
        for j in range(0, ny, rows):
            last = min(ny, j + rows)
            if not whole and (j < far or far == 0 or ints[PERIODIC + 1] == 0):
                rows_of_box(q, j + ny * k, last - j, False, floats, ints)
            part_of_band(u, y1, end, q, scales, j, last, k, ints)
            for c in range(nx * (j + ny * k), nx * (last + ny * k)):
                pressure_after[c] = pressure[c] + (q[c] * part - damped * gathered[c])
