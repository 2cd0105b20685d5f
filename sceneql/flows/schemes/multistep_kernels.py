# mypy: ignore-errors
"""A step that is explicit in advection and implicit in viscosity and diffusion, then projected.

lead u1 = a1 u0 + a2 u_before + h (b1 N0 + b2 N_before) + h L (implicit u* + explicit u0) - h grad p, where L is the sum
over faces of g (neighbor - u) of every field whose g do not vary, and N all other rates, unprojected. u1 is u* without
its divergence; the pressure grows by what that takes away, less viscosity times the divergence (Brown, Cortez & Minion
2001, J. Comput. Phys. 168, 464-499; Guermond & Shen 2004, Math. Comp. 73, 1719-1737), or is left out (Chorin 1968).

``settings``: start and end of the latest step, length of the one before it. ``numbers``: [scheme, 1 if there is a step
before, how often a step went on from the one before, number of operators, where the flow's integers begin, operators of
velocities, which come first], then of each operator OPERATOR integers (a field's offset in y, cells along x, y, z,
volumes, 0 where nothing is solved, sinks, conductances along x, y, z; offsets into the tables, which follow the
settings, of decay rates by mode along x, y, z, and of the length of all transforms, the volume of a cell and the sum of
its conductances; the entry of y that tells what has come in, or -1; 1 where the transforms solve it; the plans of the
transforms, flows/layout).
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.flows.box_modes_kernels import through_modes
from sceneql.flows.layout import (
    AT,
    CELLS,
    FREE_FREE,
    FREE_NODES,
    ITERATES,
    KIND,
    NODES,
    NODES_FREE,
    PLAN,
    PRESSURE,
    SKIP,
    VELOCITY,
    WORK,
)
from sceneql.flows.projection_kernels import less_gradient, outflow, project, rid
from sceneql.grids.multigrid.stencil_kernels import dot, multiply
from sceneql.system.signatures_kernels import STEP, A, F, I, N

CHORIN, CNAB2, SBDF2 = range(3)
SCHEME, HAS_BEFORE, TURN, OPERATORS, FLOW_AT, VELOCITIES, HEAD = range(7)
START, END, LENGTH, VISCOSITY, TABLES = range(5)
DECAYS, SIZES_AT, TALLY, EXACT, PLANS_AT = 9, 12, 13, 14, 15
OPERATOR = PLANS_AT + 3 * PLAN
GOES_ON, REPEATS, BEGINS = range(3)
ARRAYS = 11
SMALL = 1e-10
"""Residual of implicit parts, in parts of the right side."""
MOST = 200
EASY = 20.0
"""Largest decay in a step that the diagonal is the cheaper preconditioner for."""


@lean_inlined
def same(x, y):
    """Whether all entries are equal."""
    for k in range(x.size):
        if x[k] != y[k]:
            return False
    return True


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
def by_decay(op, a, z, tables, scratch):
    """Divide the eigenmodes of a box by 1 + a times their decay rates, in place."""
    nx, ny, nz = op[1], op[2], op[3]
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
                        x[beside] += a * ties[beside if way == 0 else end] * x[end] / volume[beside]
                        ends[kept], x[end] = x[end], 0.0
                    kept += 1
        if back == 0:
            by_decay(op, a, x, tables, scratch)


@lean(types.boolean(I, F, A, A, F, A, A, A, A), inner=True)
def solve(op, a, wanted, y, small, floats, tables, scratch, room):
    """Solve (V - a L) x = V wanted for the entries of an operator, in y, from the values there; where V is 0 they stay.

    On a box of one coefficient by transforms; else by conjugate gradients with these and the own entries of cut cells
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
    scale = 1.0 / a
    multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, x, q)
    for c in range(n):
        r[c] = volume[c] * aim[c] - a * q[c] if volume[c] > 0.0 else 0.0
    easy = 2.0 * a * tables[op[SIZES_AT] + 2] < EASY * tables[op[SIZES_AT] + 1]
    diagonal(op, a, easy, floats, tables, own)
    target = before = 0.0
    for c in range(n):
        target += volume[c] * aim[c] ** 2
        p[c] = 0.0
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


@lean_inlined
def remember(t, y0, start, before, end, settings, numbers, settled):
    """How a step goes on: GOES_ON from the latest, whose end is its start then, REPEATS that, or BEGINS."""
    if t == settings[END] and (settled or same(y0, end)):
        settings[LENGTH] = settings[END] - settings[START]
        numbers[HAS_BEFORE] = 1
        numbers[TURN] += 1
        return GOES_ON
    if t == settings[START] and same(y0, start):
        return REPEATS
    numbers[HAS_BEFORE] = 0
    for k in range(y0.size):
        start[k] = y0[k]
    return REPEATS if t == settings[START] else BEGINS


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; returns 0."""
    n = y0.size
    rate1, wanted, spreading, room = work[:n], work[6 * n : 7 * n], work[7 * n : 8 * n], work[8 * n :]
    one = numbers[numbers[FLOW_AT] :]
    cells = one[CELLS] * one[CELLS + 1] * one[CELLS + 2]
    pressures = work[ARRAYS * n : ARRAYS * n + 3 * cells]
    q = floats[one[PRESSURE] : one[PRESSURE] + cells]
    scheme = numbers[SCHEME]
    rate = rate_at(functions[AT_RATE])
    states = work[n : 4 * n]  # those of the latest three times, which take turns
    turn = numbers[TURN] % 3
    start, before = states[turn * n : (turn + 1) * n], states[(turn + 2) % 3 * n :]
    how = remember(
        t, y0, start, before, states[(turn + 1) % 3 * n :], settings, numbers, floats[channels.SETTLED] != 0.0
    )
    turn = numbers[TURN]
    before, end = states[(turn + 2) % 3 * n :], states[(turn + 1) % 3 * n :]
    latest, n_before = work[(4 + turn % 2) * n : (5 + turn % 2) * n], work[(5 - turn % 2) * n :]
    pressure, pressure_after = pressures[turn % 2 * cells :], pressures[(1 - turn % 2) * cells :]
    has_before = numbers[HAS_BEFORE] == 1
    if how == BEGINS:  # the pressure of the start, or after a change from outside
        rate(t, y0, latest, floats, ints)
        for c in range(cells):
            pressure[c] = q[c]
    settings[START], settings[END] = t, t + h
    floats[one[SKIP]] = 1.0
    rate(t, y0, latest, floats, ints)
    floats[one[SKIP]] = 0.0
    w = h / settings[LENGTH] if has_before else 0.0
    lead, a1, a2, b1, b2, implicit = 1.0, 1.0, 0.0, 1.0, 0.0, 1.0
    if scheme == CNAB2:
        b1, b2, implicit = 1.0 + 0.5 * w, -0.5 * w, 0.5
    elif scheme == SBDF2:
        lead, a1, a2 = (1.0 + 2.0 * w) / (1.0 + w), 1.0 + w, -w * w / (1.0 + w)
        b1, b2 = 1.0 + w, -w
    add_spread(y0, latest, -1.0, numbers[VELOCITIES], spreading, floats, numbers)
    first, second, new, former = a1 / lead, a2 / lead, h * b1 / lead, h * b2 / lead
    if has_before:
        for k in range(n):
            y1[k] = first * y0[k] + second * before[k] + new * latest[k] + former * n_before[k]
    else:
        for k in range(n):
            y1[k] = (first + second) * y0[k] + (new + former) * latest[k]
    if implicit < 1.0:
        add_spread(y0, y1, h * (1.0 - implicit), 0, spreading, floats, numbers)
    if scheme != CHORIN:
        less_gradient(y1, pressure, h / lead, floats, one)
    solved, ahead, tables = True, w if has_before else 0.0, settings[TABLES:]
    for number in range(numbers[OPERATORS]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        size = op[1] * op[2] * op[3]
        x = y1[op[0] : op[0] + size]
        if op[EXACT] == 1:
            by_modes(op, h * implicit / lead, x, floats, tables, floats[one[WORK] :], room)
            continue
        volume, aim = floats[op[4] : op[4] + size], wanted[op[0] : op[0] + size]
        x0, x_before = y0[op[0] : op[0] + size], before[op[0] : op[0] + size]
        for c in range(size):  # iterations begin with the values that go on as they went
            aim[c] = x[c]
            x[c] = x0[c] + ahead * (x0[c] - x_before[c]) if volume[c] > 0.0 else x[c]
        solved &= solve(op, h * implicit / lead, wanted, y1, SMALL, floats, tables, floats[one[WORK] :], room)
    gathered, latest_q = room[:cells], pressures[2 * cells :]
    outflow(y1, gathered, VELOCITY, floats, one)
    if has_before and one[ITERATES] > 0:  # iterations begin with what the step before took away
        less_gradient(y1, latest_q, 1.0, floats, one)
        solved &= project(y1, VELOCITY, floats, one)
        for c in range(cells):
            q[c] += latest_q[c]
    else:
        for c in range(cells):
            q[c] = -gathered[c]
        solved &= rid(y1, VELOCITY, floats, one)
    if one[ITERATES] > 0:
        for c in range(cells):
            latest_q[c] = q[c]
    part, damped = lead / h, implicit * settings[VISCOSITY]
    for c in range(cells):
        pressure_after[c] = pressure[c] + (q[c] * part - damped * gathered[c])
    for number in range(numbers[OPERATORS]):
        tally(numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)], y0, y1, floats)
    bend = w / (1.0 + w) if has_before else 0.0
    slope, before_slope = (1.0 + bend) / h, -bend / settings[LENGTH] if has_before else 0.0
    old = before if has_before else y0
    for k in range(n):
        rate1[k] = slope * (y1[k] - y0[k]) + before_slope * (y0[k] - old[k])
        end[k] = y1[k]
    if not solved:
        y1[one[AT]] = math.nan
    return 0.0
