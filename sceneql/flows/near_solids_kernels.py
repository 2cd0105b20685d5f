# mypy: ignore-errors
"""The pressure's equation of a box that solids cut: conjugate gradients that know of the cells near these alone.

The box's own equation, A0, is solved by fast transforms, M; the true one, A, differs from it in rows near solids. Of a
residual r that is 0 elsewhere A M r = r + (A - A0) M r is 0 elsewhere too. So from the first guess M b on all vectors
of the iterations are sums of M times numbers of few cells, and of numbers of these, and but for the transforms the work
goes by their number (the idea of capacitance matrices: Buzbee, Dorr, George & Golub 1971, SIAM J. Numer. Anal. 8,
722-736; Proskurowski & Widlund 1976, Math. Comp. 30, 433-468).
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.box_modes_kernels import through_few_rows, through_modes
from sceneql.flows.layout import (
    CELLS,
    CONDUCTANCES,
    CUT,
    KIND,
    PERIODIC,
    PLAN,
    PLANS,
    QUARTER_COSINES,
    QUARTER_SINES,
    SINES,
    SINGULAR,
    SINK,
    SPECTRUM,
    UNCUT,
    WORK,
)
from sceneql.flows.lines_kernels import FEWEST, through_lines
from sceneql.grids.multigrid.stencil_kernels import dot, flow
from sceneql.system.signatures_kernels import A, F, I, N

LISTS = 12
"""Numbers of each cell of the list, of which there is room for a third of all."""
ROUNDING = 1e-9
"""Difference from a face that is not cut, in parts, that counts as rounding."""
MOST = 400
"""Iterations."""


@lean_inlined
def by_lines(ints):
    """Whether the box's equation is solved by lines_kernels, whose store SPECTRUM is then."""
    return ints[CELLS + 2] == 1 and ints[CELLS + 1] >= FEWEST


@lean_inlined
def opened(kind, high):
    """Whether the pressure is 0 beyond an end of an axis."""
    if high:
        return kind == SINES or kind == QUARTER_COSINES
    return kind == SINES or kind == QUARTER_SINES


@lean_inlined
def like_box(c, place, axis, stride, floats, ints):
    """Whether a cell's faces across an axis, the ``place``-th along it, are those of the box; and its sink's part."""
    uncut, count = floats[ints[UNCUT] + axis], ints[CELLS + axis]
    around, kind = ints[PERIODIC + axis] == 1, ints[PLANS + PLAN * axis + KIND]
    low, high = uncut, uncut
    sink = 0.0
    after = c + stride
    if place == 0 and not around:
        low = 0.0
        sink += 2.0 * uncut if opened(kind, False) else 0.0
    if place == count - 1:
        after = c - (count - 1) * stride
        if not around:
            high = 0.0
            sink += 2.0 * uncut if opened(kind, True) else 0.0
    g = floats[ints[CONDUCTANCES + axis] :]
    least = ROUNDING * uncut
    return abs(g[c] - low) <= least and abs(g[after] - high) <= least, sink


@lean_inlined
def beside(c, way, nx, ny, nz):
    """The neighbor of a cell one of six ways, around the box."""
    axis, step = way // 2, 2 * (way % 2) - 1
    stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
    count = nx if axis == 0 else (ny if axis == 1 else nz)
    place = (c // stride) % count + step
    if place < 0:
        return c + (count - 1) * stride
    return c - (count - 1) * stride if place == count else c + step * stride


@lean_inlined
def inner_row_is_whole(row, nx, plane, deep, floats, ints):
    """Whether all cells of a row but its ends, off the sides of the box, have the box's equation."""
    sink, gx, gy = (
        floats[ints[SINK] + row :],
        floats[ints[CONDUCTANCES] + row :],
        floats[ints[CONDUCTANCES + 1] + row :],
    )
    above, x, y = gy[nx:], floats[ints[UNCUT]], floats[ints[UNCUT] + 1]
    least, odd = ROUNDING * min(x, y), 0
    for i in range(1, nx - 1):
        odd += abs(gx[i] - x) > least
        odd += abs(gx[i + 1] - x) > least
        odd += abs(gy[i] - y) > least
        odd += abs(above[i] - y) > least
        odd += sink[i] != 0.0
    if deep and odd == 0:
        gz, z = floats[ints[CONDUCTANCES + 2] + row :], floats[ints[UNCUT] + 2]
        front = gz[plane:]
        for i in range(1, nx - 1):
            odd += abs(gz[i] - z) > least
            odd += abs(front[i] - z) > least
    return odd == 0


@lean_inlined
def box_is_open(ints):
    """Whether the pressure is 0 beyond a whole side of the box."""
    for axis in range(3 if ints[CELLS + 2] > 1 else 2):
        kind = ints[PLANS + PLAN * axis + KIND]
        if opened(kind, False) or opened(kind, True):
            return True
    return False


@lean(types.int64(A, A, A, N, A, I), inner=True)
def near_solids(marks, cells, cuts, most, floats, ints):
    """List the cells whose equation is not the box's, and their neighbors; how many, -1: more than ``most``.

    Also -1 where there are ways out, but no whole side is one: of the closed box M knows only what sums to 0.

    ``cuts``: of each 1/(2 its own entry), 0 of neighbors; ``marks``: scratch (cells,).
    """
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    if ints[SINGULAR] == 0 and not box_is_open(ints):
        return -1
    sink = floats[ints[SINK] :]
    count, axes, plane = 0, 3 if nz > 1 else 2, nx * ny
    for k in range(nz):
        for j in range(ny):
            row = nx * (j + ny * k)
            for i in range(nx):
                marks[row + i] = 0.0
            inner = 0 < j < ny - 1 and (nz == 1 or 0 < k < nz - 1)
            apart = nx - 1 if inner and inner_row_is_whole(row, nx, plane, nz > 1, floats, ints) else 1
            for i in range(0, nx, apart):
                c = row + i
                if sink[c] < 0.0:
                    continue
                alike, total = like_box(c, i, 0, 1, floats, ints)
                here, more = like_box(c, j, 1, nx, floats, ints)
                alike, total = alike and here, total + more
                if nz > 1:
                    here, more = like_box(c, k, 2, plane, floats, ints)
                    alike, total = alike and here, total + more
                if alike and abs(sink[c] - total) <= ROUNDING * floats[ints[UNCUT]]:
                    continue
                if count == most:
                    return -1
                marks[c], cells[count], cuts[count] = 1.0, c, floats[ints[CUT] + c]
                count += 1
    first = count
    for number in range(first):
        for way in range(2 * axes):
            c = beside(int(cells[number]), way, nx, ny, nz)
            if marks[c] == 0.0 and sink[c] >= 0.0:
                if count == most:
                    return -1
                marks[c], cells[count], cuts[count] = 1.0, c, 0.0
                count += 1
    return count


@lean_inlined
def at_cells(count, cells, x, out, floats, ints):
    """out = A x at the cells of a list; x is of all."""
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    n, plane, deep = nx * ny * nz, nx * ny, nz > 1
    sink, gx, gy = floats[ints[SINK] :], floats[ints[CONDUCTANCES] :], floats[ints[CONDUCTANCES + 1] :]
    gz = floats[ints[CONDUCTANCES + 2] : ints[CONDUCTANCES + 2] + (n if deep else 0)]
    for number in range(count):
        c = int(cells[number])
        i, j, k = c % nx, (c // nx) % ny, c // plane
        left, right = c - 1 if i > 0 else c + nx - 1, c + 1 if i < nx - 1 else c - nx + 1
        low, high = c - nx if j > 0 else c + plane - nx, c + nx if j < ny - 1 else c - plane + nx
        back, front = c - plane if k > 0 else c + n - plane, c + plane if k < nz - 1 else c - n + plane
        out[number] = sink[c] * x[c] - flow(x, gx, gy, gz, c, left, right, low, high, back, front, deep)


@lean_inlined
def range_of(count, cells, stride, most):
    """From and to which row, or plane, the cells of a list and their neighbors stand; all where they go around."""
    first, last = most, -1
    for number in range(count):
        place = (int(cells[number]) // stride) % most
        first, last = min(first, place - 1), max(last, place + 1)
    return (0, most) if first < 0 or last >= most else (first, last + 1)


@lean(types.boolean(A, F, N, A, A, I), inner=True)
def by_few(b, small, count, room, floats, ints):
    """Solve the pressure's equation in place, to a residual; whether it was reached. b is as `centered` leaves it.

    ``room``: 5 numbers a cell; begins with the ``count`` cells that are listed, and their own entries a third on.
    """
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    n = nx * ny * nz
    most = n // 3
    lists = room[: LISTS * most]
    cells, cuts = lists[:count], lists[most : most + count]
    r, s, e, q = (
        lists[2 * most :][:count],
        lists[3 * most :][:count],
        lists[4 * most :][:count],
        lists[5 * most :][:count],
    )
    p_source, p_own = lists[6 * most :][:count], lists[7 * most :][:count]
    p, of_p = lists[8 * most :][:count], lists[9 * most :][:count]
    x_source, x_own = lists[10 * most :][:count], lists[11 * most :][:count]
    z, spectrum, flat = room[4 * n :], floats[ints[SPECTRUM] :], by_lines(ints)
    scratch, plans = floats[ints[WORK] :], ints[PLANS:]
    from_row, to_row = range_of(count, cells, nx, ny)
    from_plane, to_plane = range_of(count, cells, nx * ny, nz) if nz > 1 else (0, 1)
    start, stop = (nx * ny * from_plane, nx * ny * to_plane) if nz > 1 else (nx * from_row, nx * to_row)
    box, rows, none = (from_row, to_row, from_plane, to_plane), (from_row, to_row), floats[:0]
    for c in range(n):
        z[c] = b[c]
    if flat:
        through_lines(z, nx, ny, floats, scratch, plans, spectrum, rows, False, True)
    else:
        through_few_rows(z, nx, ny, nz, floats, scratch, plans, spectrum, box, False, True)
    at_cells(count, cells, z, q, floats, ints)
    for number in range(count):
        r[number] = b[int(cells[number])] - q[number]
        x_source[number], x_own[number] = 0.0, 0.0
    before, solved = 0.0, False
    for turn in range(MOST):
        left = math.sqrt(dot(r, r))
        if not left > small:
            solved = left <= small
            break
        for c in range(start, stop):
            z[c] = 0.0
        for number in range(count):
            e[number] = cuts[number] * r[number]
            z[int(cells[number])] = e[number]
        at_cells(count, cells, z, q, floats, ints)
        for number in range(count):
            s[number] = r[number] - q[number]
            z[int(cells[number])] = s[number]
        if flat:
            through_lines(z, nx, ny, floats, scratch, plans, spectrum, rows, True, True)
        else:
            through_few_rows(z, nx, ny, nz, floats, scratch, plans, spectrum, box, True, True)
        for number in range(count):
            z[int(cells[number])] += e[number]
        at_cells(count, cells, z, q, floats, ints)
        for number in range(count):
            more = cuts[number] * (r[number] - q[number])
            e[number] += more
            z[int(cells[number])] += more
        at_cells(count, cells, z, q, floats, ints)
        now = 0.0
        for number in range(count):
            now += r[number] * z[int(cells[number])]
        part = now / before if turn > 0 else 0.0
        for number in range(count):
            p[number] = z[int(cells[number])] + part * (p[number] if turn > 0 else 0.0)
            of_p[number] = q[number] + part * (of_p[number] if turn > 0 else 0.0)
            p_source[number] = s[number] + part * (p_source[number] if turn > 0 else 0.0)
            p_own[number] = e[number] + part * (p_own[number] if turn > 0 else 0.0)
        length = now / dot(p, of_p)
        for number in range(count):
            x_source[number] += length * p_source[number]
            x_own[number] += length * p_own[number]
            r[number] -= length * of_p[number]
        before = now
    for number in range(count):
        b[int(cells[number])] += x_source[number]
    if flat:
        through_lines(b, nx, ny, floats, scratch, plans, spectrum, (0, ny), False, False)
    else:
        through_modes(b, nx, ny, nz, floats, scratch, plans, spectrum, none, none, none, 0.0, 0.0)
    for number in range(count):
        b[int(cells[number])] += x_own[number]
    return solved
