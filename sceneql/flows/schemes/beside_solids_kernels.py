# mypy: ignore-errors
"""Implicit viscosity where solids cut few cells of a box: the whole box by transforms, then cells about solids alone.

Of what transforms find, only cells whose equation is not the box's have a residual. What it changes fades from there
by a factor from each cell to the next, the slower the longer the step; so conjugate gradients in the cells up to as
far off as that needs do the rest. What they leave beyond these is measured.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import load, store
from sceneql.flows.schemes.operator_layout import ODD, SIZES_AT
from sceneql.grids.multigrid.stencil_kernels import LANE, flow, flow_of_lanes
from sceneql.system.signatures_kernels import A, F, I, N

MOST = 200
"""Iterations."""
PART = 0.5
"""The largest part of all cells to iterate on."""
GAP = 16
"""Fewest cells in a row with nothing to solve that part it: as within solids."""
NEARER = 0.9
"""Part of the residual that is asked for which iterations end at, as more is found where they were not."""
SPAN = 3
"""Numbers of a stretch of cells of a row: the row, and from and to before which cell."""


@lean_inlined
def reach(op, a, small, tables):
    """How many cells from those whose equation is not the box's solids change something.

    Along a line of cells that falls by a factor e^k from each to the next, cosh k = 1 + V/(2 a g).
    """
    whole, ties = tables[op[SIZES_AT] + 1], 0.5 * a * tables[op[SIZES_AT] + 2]
    return int(math.log(10.0 / small) / math.acosh(1.0 + 0.5 * whole / ties)) + 2 if ties > 0.0 else 2


@lean_inlined
def widest_beside(low, high, count, stride, more, wide_low, wide_high):
    """Of each row the hull of those of rows up to ``more`` off along an axis, round it."""
    off = min(more, count // 2)
    for row in range(low.size):
        place, first, last = (row // stride) % count, low[row], high[row]
        for step in range(-off, off + 1):
            other = row + ((place + step) % count - place) * stride
            first, last = min(first, low[other]), max(last, high[other])
        wide_low[row], wide_high[row] = first, last


@lean(types.int64(I, N, A, A, A), inner=True)
def spans_around(op, more, odd, volume, spans):
    """List the stretches of rows where there is something to solve, up to ``more`` cells along each axis from ``odd``.

    That is the number of rows with such cells, then of each the row and from and to before which cell they stand.
    Returns how many stretches ``spans`` begins with, SPAN numbers each; -1: too many. Room: n numbers.
    """
    nx, ny, nz = op[1], op[2], op[3]
    rows = ny * nz
    if spans.size < 8 * rows:
        return -1
    own = spans[spans.size - 4 * rows :]
    low, high, wide_low, wide_high = own[:rows], own[rows : 2 * rows], own[2 * rows : 3 * rows], own[3 * rows :]
    for row in range(rows):
        low[row], high[row] = nx, 0.0
    for number in range(int(odd[0])):
        row = int(odd[1 + SPAN * number])
        low[row], high[row] = odd[2 + SPAN * number], odd[3 + SPAN * number]
    widest_beside(low, high, ny, 1, more, wide_low, wide_high)
    widest_beside(wide_low, wide_high, nz, ny, more, low, high)
    count, cells, most = 0, 0, (spans.size - 4 * rows) // SPAN
    for row in range(rows):
        if high[row] <= low[row]:
            continue
        first, last = int(low[row]) - more, int(high[row]) + more
        if first < 0 or last > nx:
            first, last = 0, nx
        begin = end = -1
        for i in range(first, last + 1):
            solid = i == last or not volume[nx * row + i] > 0.0
            if not solid:
                begin = i if begin < 0 else begin
                end = i + 1
            elif begin >= 0 and (i == last or i - end + 1 >= GAP):
                if count == most:
                    return -1
                spans[SPAN * count], spans[SPAN * count + 1], spans[SPAN * count + 2] = row, begin, end
                count, cells, begin = count + 1, cells + end - begin, -1
    return count if cells <= PART * nx * rows else -1


@lean_inlined
def beside(place, count, stride):
    """How far off the cells before and behind one stand, round the box."""
    return ((place - 1) % count - place) * stride, ((place + 1) % count - place) * stride


@lean_inlined
def rows_beside(row, nx, ny, nz):
    """How far off the cells of the rows before and behind one stand along y, and along z."""
    low, high = beside(row % ny, ny, nx)
    down, up = beside(row // ny, nz, nx * ny)
    return low, high, down, up


@lean_inlined
def own_entries(op, a, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, out):
    """1/(V - a L)'s own entries in a row from cell ``first`` to before ``last``; 0 where V is 0."""
    nx, deep = op[1], op[3] > 1
    for i in range(first, last):
        c = row + i
        total = sink[c] + gx[c] + gx[c + 1 if i < nx - 1 else row] + gy[c] + gy[c + high]
        if deep:
            total += gz[c] + gz[c + up]
        out[c] = 1.0 / (volume[c] + a * total) if volume[c] > 0.0 else 0.0


@lean_inlined
def row_of(op, scale, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, x, out):
    """out = (V scale - L) x in a row from cell ``first`` to before ``last``; returns x . out there."""
    nx, deep = op[1], op[3] > 1
    whole, rest = 0.0, max(first, 1)
    to = min(last, nx - 1)
    for c in range(row + rest, row + to - LANE + 1, LANE):
        total = flow_of_lanes(x, gx, gy, gz, c, c + low, c + high, c + down, c + up, deep)
        store(out, c, (scale * load(volume, c) + load(sink, c)) * load(x, c) - total)
        rest += LANE
    for i in range(rest, to):
        c = row + i
        total = flow(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
        out[c] = (scale * volume[c] + sink[c]) * x[c] - total
    for i in range(0, nx, max(1, nx - 1)):
        if first <= i < last:
            c = row + i
            left, right = (row + nx - 1 if i == 0 else c - 1), (row if i == nx - 1 else c + 1)
            total = flow(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
            out[c] = (scale * volume[c] + sink[c]) * x[c] - total
    for c in range(row + first, row + last):
        whole += x[c] * out[c]
    return whole


@lean(types.float64(I, F, N, A, A, A, A, A, A, A, A, A, A, A), inner=True)
def left_over(op, a, count, spans, aim, x, volume, sink, gx, gy, gz, r, own, q):
    """The residual r in some stretches of rows, and own entries there; returns r . (own r)."""
    nx, found = op[1], 0.0
    for number in range(count):
        row, first, last = int(spans[SPAN * number]), int(spans[SPAN * number + 1]), int(spans[SPAN * number + 2])
        low, high, down, up = rows_beside(row, nx, op[2], op[3])
        row *= nx
        own_entries(op, a, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, own)
        row_of(op, 1.0 / a, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, x, q)
        for c in range(row + first, row + last):
            r[c] = volume[c] * aim[c] - a * q[c] if volume[c] > 0.0 else 0.0
            found += r[c] * (own[c] * r[c])
    return found


@lean(types.boolean(I, F, F, F, A, A, A, A, A, A, A, A, A, A, A, A, A), inner=True)
def solved_around(op, a, small, enough, aim, x, volume, sink, gx, gy, gz, r, p, q, own, spans, tables):
    """Solve (V - a L) x = V aim about solids, where all else is solved for already: until r . (own r) is ``enough``.

    Whether it is, one cell further off, too. p is 0 everywhere at first; ``spans``: scratch, as long.
    """
    nx, more, odd = op[1], reach(op, a, small, tables), tables[op[ODD] :]
    some = spans_around(op, more, odd, volume, spans)
    if some < 0:
        return False
    scale, before = 1.0 / a, 0.0
    now = left_over(op, a, some, spans, aim, x, volume, sink, gx, gy, gz, r, own, q)
    for count in range(MOST):
        if not now > NEARER * enough:
            some = spans_around(op, more + 1, odd, volume, spans)
            if some < 0:
                return False
            now = left_over(op, a, some, spans, aim, x, volume, sink, gx, gy, gz, r, own, q)
            return 0.0 <= now <= enough
        part = now / before if count > 0 else 0.0
        for number in range(some):
            row = nx * int(spans[SPAN * number])
            for c in range(row + int(spans[SPAN * number + 1]), row + int(spans[SPAN * number + 2])):
                p[c] = own[c] * r[c] + part * p[c]
        along = 0.0
        for number in range(some):
            row, first, last = int(spans[SPAN * number]), int(spans[SPAN * number + 1]), int(spans[SPAN * number + 2])
            low, high, down, up = rows_beside(row, nx, op[2], op[3])
            along += row_of(op, scale, nx * row, low, high, down, up, first, last, volume, sink, gx, gy, gz, p, q)
        length = now / (a * along)
        step, before, now = length * a, now, 0.0
        for number in range(some):
            row = nx * int(spans[SPAN * number])
            begin, end = row + int(spans[SPAN * number + 1]), row + int(spans[SPAN * number + 2])
            for c in range(begin, end):
                x[c] += length * p[c]
                r[c] -= step * q[c]
            for c in range(begin, end):
                now += r[c] * (own[c] * r[c])
    return False
