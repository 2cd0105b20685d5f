# mypy: ignore-errors
"""Viscosity and diffusion of the fields of a flow: L u, and (V - a L) x = V w solved.

L is the sum over faces of g (neighbor - u) of every field whose g do not vary. ``numbers`` holds, from HEAD on, of each
operator OPERATOR integers (a field's offset in y, cells along x, y, z, volumes, 0 where nothing is solved, sinks,
conductances along x, y, z; offsets into the tables of decay rates by mode along x, y, z, and of the length of all
transforms, the volume of a cell and the sum of its conductances; then as in operator_layout); numbers[OPERATORS] is
their number.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.box_modes_kernels import through_modes
from sceneql.flows.layout import FREE_FREE, FREE_NODES, KIND, LENGTH, NODES, NODES_FREE, PLAN
from sceneql.flows.lines_kernels import prepare, through_lines
from sceneql.flows.schemes.beside_solids_kernels import solved_around
from sceneql.flows.schemes.operator_layout import (
    A_OF,
    DECAYS,
    EXACT,
    LINES,
    ODD,
    OPERATOR,
    PLANS_AT,
    SIZE_OF,
    SIZES_AT,
    STORE_OF,
    TALLY,
    TIE_OF,
)
from sceneql.grids.multigrid.stencil_kernels import dot, multiply
from sceneql.system.signatures_kernels import A, F, I, N

OPERATORS, HEAD = 3, 6
MOST = 200
EASY = 20.0
"""Largest decay in a step that the diagonal is the cheaper preconditioner for."""


@lean(types.void(A, A, N, N, A, I), inner=True)
def spread(y, out, first, last, floats, numbers):
    """out = L y where the operators from ``first`` to before ``last`` act."""
    for number in range(first, last):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        at, nx, ny, nz = op[0], op[1], op[2], op[3]
        n = nx * ny * nz
        x, volume, sink = y[at : at + n], floats[op[4] : op[4] + n], floats[op[5] : op[5] + n]
        gx, gy = floats[op[6] : op[6] + n], floats[op[7] : op[7] + n]
        gz, own = floats[op[8] : op[8] + (n if nz > 1 else 0)], out[at : at + n]
        multiply(nx, ny, nz, 0.0, volume, sink, gx, gy, gz, x, own)
        for c in range(n):
            own[c] = -own[c] / volume[c] if volume[c] > 0.0 else 0.0


@lean_inlined
def more_at_end(place, count, kind):
    """2 where the own cell of a face is half a one, as it is free on the boundary; else 1."""
    low, high = kind == FREE_NODES or kind == FREE_FREE, kind == NODES_FREE or kind == FREE_FREE
    return 2.0 if (low and place == 0) or (high and place == count - 1) else 1.0


@lean_inlined
def by_lines(op, a, tables):
    """Whether a flat field's equation is solved by lines_kernels, whose store is filled for a then."""
    if op[LINES] < 0:
        return False
    head = tables[op[LINES] :]
    if head[A_OF] != a:
        nx, ny, plans = op[1], op[2], op[PLANS_AT:]
        store, along_x = head[STORE_OF : STORE_OF + int(head[SIZE_OF])], tables[op[DECAYS] :][:nx]
        tie, length = a * head[TIE_OF], 1.0 * plans[LENGTH]
        filled = prepare(store, nx, ny, plans[PLAN + KIND], 0.0, 1.0, a, along_x, tie, length) >= 0
        head[A_OF] = a if filled else math.nan
    return head[A_OF] == a


@lean_inlined
def by_decay(op, a, z, tables, scratch):
    """Divide the eigenmodes of a box by 1 + a times their decay rates, in place."""
    nx, ny, nz = op[1], op[2], op[3]
    if by_lines(op, a, tables):
        store = tables[op[LINES] + STORE_OF :]
        through_lines(z, nx, ny, tables, scratch, op[PLANS_AT:], store, (0, ny), False, False)
        return
    x, y, z_rates = tables[op[DECAYS] :][:nx], tables[op[DECAYS + 1] :][:ny], tables[op[DECAYS + 2] :][:nz]
    size = tables[op[SIZES_AT]]
    through_modes(z, nx, ny, nz, tables, scratch, op[PLANS_AT:], tables[:0], x, y, z_rates, a, size)


@lean(types.void(A, A, A, F, A, A, I), inner=True)
def precondition(r, z, volume, a, tables, scratch, op):
    """z = (1 - a coefficient lap)^-1 (r / V) with the volumes V of the uncut box, so that it is symmetric; 0 where
    ``volume`` is."""
    nx, ny, nz = op[1], op[2], op[3]
    plans, whole = op[PLANS_AT:], tables[op[SIZES_AT] + 1]
    for k in range(nz):
        deep = more_at_end(k, nz, plans[2 * PLAN + KIND]) / whole if nz > 1 else 1.0 / whole
        for j in range(ny):
            both, row = deep * more_at_end(j, ny, plans[PLAN + KIND]), nx * (j + ny * k)
            for c in range(row, row + nx):
                z[c] = both * r[c] if volume[c] > 0.0 else 0.0
            z[row] *= more_at_end(0, nx, plans[KIND])
            z[row + nx - 1] *= more_at_end(nx - 1, nx, plans[KIND])
    by_decay(op, a, z, tables, scratch)
    for c in range(z.size):
        z[c] = z[c] if volume[c] > 0.0 else 0.0


@lean_inlined
def diagonal(op, a, easy, floats, tables, out):
    """1/(V - a L)'s own entries; 0 where V is 0. Where it is not easy half of them, and 0 in cells of the whole box."""
    nx, ny, nz = op[1], op[2], op[3]
    plane = nx * ny
    n = plane * nz
    volume, sink = floats[op[4] : op[4] + n], floats[op[5] : op[5] + n]
    gx, gy = floats[op[6] : op[6] + n], floats[op[7] : op[7] + n]
    gz = floats[op[8] : op[8] + (n if nz > 1 else 0)]
    uncut = tables[op[SIZES_AT] + 1] + a * tables[op[SIZES_AT] + 2]
    for k in range(nz):
        up = ((k + 1) % nz - k) * plane
        for j in range(ny):
            high = ((j + 1) % ny - j) * nx
            for i in range(nx):
                c = i + nx * (j + ny * k)
                total = sink[c] + gx[c] + gx[c + 1 if i < nx - 1 else c - i] + gy[c] + gy[c + high]
                if nz > 1:
                    total += gz[c] + gz[c + up]
                whole = volume[c] + a * total
                if volume[c] == 0.0:
                    out[c] = 0.0
                elif easy:
                    out[c] = 1.0 / whole
                else:
                    out[c] = 0.5 / whole if abs(whole - uncut) > 1e-9 * uncut else 0.0


@lean(types.void(I, F, A, A, A, A, A), inner=True)
def by_modes(op, a, x, floats, tables, scratch, ends):
    """Solve (V - a L) x = V times what stands in x, in place, on a box of one coefficient; where V is 0, x stays.

    That is at the ends of an axis. ``ends``: scratch, twice as long as such an end.
    """
    nz, plans, counts = op[3], op[PLANS_AT:], op[1:4]
    volume, kept = floats[op[4] : op[4] + x.size], 0
    for back in range(2):
        kept = 0
        for axis in range(2 if nz == 1 else 3):
            if not NODES <= plans[PLAN * axis + KIND] <= FREE_NODES:
                continue
            ties = floats[op[6 + axis] : op[6 + axis] + x.size]
            stride, last = 1, counts[axis] - 1
            for before in range(axis):
                stride *= counts[before]
            for row in range(x.size // counts[axis]):
                low = (row // stride) * stride * counts[axis] + row % stride
                for way in range(2):
                    end = low if way == 0 else low + last * stride
                    if volume[end] > 0.0:
                        continue
                    if back == 1:
                        x[end] = ends[kept]
                    else:
                        beside = end + stride if way == 0 else end - stride
                        if volume[beside] > 0.0:  # a solid may stand there
                            x[beside] += a * ties[beside if way == 0 else end] * x[end] / volume[beside]
                        ends[kept], x[end] = x[end], 0.0
                    kept += 1
        if back == 0:
            by_decay(op, a, x, tables, scratch)


@lean(types.boolean(I, F, A, A, F, A, A, A, A), inner=True)
def solve(op, a, wanted, y, small, floats, tables, scratch, room):
    """Solve (V - a L) x = V wanted for the entries of an operator, in y, from the values there; where V is 0 they stay.

    On a box of one coefficient by transforms; where solids cut few cells by these and conjugate gradients about solids
    (beside_solids_kernels); else by conjugate gradients with the transforms and the own entries of cut cells
    as preconditioner, or with all own entries where the equations are not stiff. ``small``: the residual, as the
    preconditioner measures it, in parts of wanted. Whether it was reached.
    """
    at, nx, ny, nz = op[0], op[1], op[2], op[3]
    n = nx * ny * nz
    x, volume, sink = y[at : at + n], floats[op[4] : op[4] + n], floats[op[5] : op[5] + n]
    gx, gy = floats[op[6] : op[6] + n], floats[op[7] : op[7] + n]
    gz, aim = floats[op[8] : op[8] + (n if nz > 1 else 0)], wanted[at : at + n]
    r, p, q, z, own = room[:n], room[n : 2 * n], room[2 * n : 3 * n], room[3 * n : 4 * n], room[4 * n : 5 * n]
    if op[EXACT] == 1:
        for c in range(n):
            x[c] = aim[c] if volume[c] > 0.0 else x[c]
        by_modes(op, a, x, floats, tables, scratch, room)
        return True
    target = before = 0.0
    for c in range(n):
        target += volume[c] * aim[c] ** 2
        p[c] = 0.0
    if op[ODD] >= 0:
        for c in range(n):
            z[c] = aim[c] if volume[c] > 0.0 else x[c]
        by_modes(op, a, z, floats, tables, scratch, r)
        for c in range(n):
            x[c] = z[c] if volume[c] > 0.0 else x[c]
        enough = small * small * target
        if solved_around(op, a, small, enough, aim, x, volume, sink, gx, gy, gz, r, p, q, own, z, tables):
            return True
        for c in range(n):
            p[c] = 0.0
    scale = 1.0 / a
    multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, x, q)
    for c in range(n):
        r[c] = volume[c] * aim[c] - a * q[c] if volume[c] > 0.0 else 0.0
    easy = 2.0 * a * tables[op[SIZES_AT] + 2] < EASY * tables[op[SIZES_AT] + 1]
    diagonal(op, a, easy, floats, tables, own)
    for count in range(MOST):
        if not easy:
            precondition(r, z, volume, a, tables, scratch, op)
            for c in range(n):
                z[c] += own[c] * r[c]
        else:
            for c in range(n):
                z[c] = own[c] * r[c]
        now = dot(r, z)
        if not now > small * small * target:
            return 0.0 <= now <= small * small * target
        part = now / before if count > 0 else 0.0
        for c in range(n):
            p[c] = z[c] + part * p[c]
        length = now / (a * multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, p, q))
        step = length * a
        for c in range(n):
            x[c] += length * p[c]
            r[c] -= step * q[c]
        before = now
    return False


@lean(types.void(I, A, A, A), inner=True)
def tally(op, y0, y1, floats):
    """What has come into a field in a step: what there is more of it, for fluxes between cells cancel."""
    if op[TALLY] >= 0:
        total = 0.0
        for c in range(op[1] * op[2] * op[3]):
            total += floats[op[4] + c] * (y1[op[0] + c] - y0[op[0] + c])
        y1[op[TALLY]] = y0[op[TALLY]] + total


@lean_inlined
def add_spread(y, out, factor, first, spreading, floats, numbers):
    """out += factor L y, where the operators from ``first`` on act."""
    spread(y, spreading, first, numbers[OPERATORS], floats, numbers)
    for number in range(first, numbers[OPERATORS]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        for k in range(op[0], op[0] + op[1] * op[2] * op[3]):
            out[k] += factor * spreading[k]
