# mypy: ignore-errors
"""Implicit viscosity where solids cut few cells of a box: the whole box by transforms, then cells about solids alone.

Of what transforms find, only cells whose equation is not the box's have a residual. What it changes fades from there
by a factor from each cell to the next, the slower the longer the step; so conjugate gradients in a box around these
cells, as wide as that needs, do the rest. What they leave beyond that box is measured.
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
"""The largest part of all cells that such a box may hold."""
BOX = types.UniTuple(N, 6)


@lean_inlined
def widened(first, last, more, count):
    """A range of cells with more on both sides; the whole axis where that goes over an end."""
    return (first - more, last + more) if first >= more and last + more <= count else (0, count)


@lean(BOX(I, F, F, A), inner=True)
def around(op, a, small, tables):
    """From and to before which cell along x, y, z to iterate; all 0 where that is too many, or nothing is known.

    Along a line of cells what solids change falls by a factor e^k from each to the next, cosh k = 1 + V/(2 a g).
    """
    count = op[1] * op[2] * op[3]
    if op[ODD] < 0:
        return 0, 0, 0, 0, 0, 0
    whole, ties = tables[op[SIZES_AT] + 1], 0.5 * a * tables[op[SIZES_AT] + 2]
    more = int(math.log(10.0 / small) / math.acosh(1.0 + 0.5 * whole / ties)) + 2 if ties > 0.0 else 2
    x, to_x = widened(op[ODD], op[ODD + 1], more, op[1])
    y, to_y = widened(op[ODD + 2], op[ODD + 3], more, op[2])
    z, to_z = widened(op[ODD + 4], op[ODD + 5], more, op[3])
    if (to_x - x) * (to_y - y) * (to_z - z) > PART * count:
        return 0, 0, 0, 0, 0, 0
    return x, to_x, y, to_y, z, to_z


@lean_inlined
def beside(place, count, stride):
    """How far off the cells before and behind one stand, round the box."""
    return ((place - 1) % count - place) * stride, ((place + 1) % count - place) * stride


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


@lean(types.float64(I, F, BOX, A, A, A, A, A, A, A, A, A, A), inner=True)
def left_over(op, a, box, aim, x, volume, sink, gx, gy, gz, r, own, q):
    """The residual r in a box, and own entries there; returns r . (own r)."""
    nx, ny, nz = op[1], op[2], op[3]
    first, last, y, to_y, z, to_z = box
    found = 0.0
    for k in range(z, to_z):
        down, up = beside(k, nz, nx * ny)
        for j in range(y, to_y):
            low, high = beside(j, ny, nx)
            row = nx * (j + ny * k)
            own_entries(op, a, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, own)
            row_of(op, 1.0 / a, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, x, q)
            for c in range(row + first, row + last):
                r[c] = volume[c] * aim[c] - a * q[c] if volume[c] > 0.0 else 0.0
                found += r[c] * (own[c] * r[c])
    return found


@lean(types.float64(I, F, BOX, A, A, A, A, A, A, A, A, A, A), inner=True)
def left_beyond(op, a, box, aim, x, volume, sink, gx, gy, gz, r, own, q):
    """The same of the cells next to a box, outside of it."""
    x0, x1, y0, y1, z0, z1 = box
    found = 0.0
    for axis in range(3):
        low, high = box[2 * axis], box[2 * axis + 1]
        if high - low == op[1 + axis]:
            continue
        for place in (low - 1, high):
            begin, end = place % op[1 + axis], place % op[1 + axis] + 1
            side = (
                (begin, end, y0, y1, z0, z1)
                if axis == 0
                else ((x0, x1, begin, end, z0, z1) if axis == 1 else (x0, x1, y0, y1, begin, end))
            )
            found += left_over(op, a, side, aim, x, volume, sink, gx, gy, gz, r, own, q)
    return found


@lean(types.boolean(I, F, BOX, F, A, A, A, A, A, A, A, A, A, A, A), inner=True)
def solved_around(op, a, box, enough, aim, x, volume, sink, gx, gy, gz, r, p, q, own):
    """Solve (V - a L) x = V aim in a box, where all else is solved for already: until r . (own r) is ``enough``.

    Whether it is, in the whole box, too. p is 0 everywhere outside.
    """
    nx, ny, nz = op[1], op[2], op[3]
    first, last, y, to_y, z, to_z = box
    scale, before = 1.0 / a, 0.0
    now = left_over(op, a, box, aim, x, volume, sink, gx, gy, gz, r, own, q)
    for count in range(MOST):
        if not now > enough:
            beyond = left_beyond(op, a, box, aim, x, volume, sink, gx, gy, gz, r, own, q)
            return 0.0 <= now <= enough and now + beyond <= enough
        part = now / before if count > 0 else 0.0
        for k in range(z, to_z):
            for j in range(y, to_y):
                row = nx * (j + ny * k)
                for c in range(row + first, row + last):
                    p[c] = own[c] * r[c] + part * p[c]
        along = 0.0
        for k in range(z, to_z):
            down, up = beside(k, nz, nx * ny)
            for j in range(y, to_y):
                low, high = beside(j, ny, nx)
                row = nx * (j + ny * k)
                along += row_of(op, scale, row, low, high, down, up, first, last, volume, sink, gx, gy, gz, p, q)
        length = now / (a * along)
        step, before, now = length * a, now, 0.0
        for k in range(z, to_z):
            for j in range(y, to_y):
                row = nx * (j + ny * k)
                for c in range(row + first, row + last):
                    x[c] += length * p[c]
                    r[c] -= step * q[c]
                for c in range(row + first, row + last):
                    now += r[c] * (own[c] * r[c])
    return False
