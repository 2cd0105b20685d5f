# mypy: ignore-errors
"""A step that is explicit in advection and implicit in viscosity and diffusion, then projected.

lead u1 = a1 u0 + a2 u_before + h (b1 N0 + b2 N_before) + h L (implicit u* + explicit u0) - h grad p, where L is the sum
over faces of g (neighbor - u) of every field whose g do not vary, and N all other rates, unprojected. u1 is u* without
its divergence; the pressure grows by what that takes away, less viscosity times the divergence (Brown, Cortez & Minion
2001, J. Comput. Phys. 168, 464-499; Guermond & Shen 2004, Math. Comp. 73, 1719-1737), or is left out (Chorin 1968).

``settings``: start and end of the latest step, length of the one before it. ``numbers``: [scheme, 1 if there is a step
before, number of operators, where the flow's integers begin, operators of velocities, which come first], then of each
operator OPERATOR integers (a field's offset in y, cells along x, y, z, volumes, 0 where nothing is solved, sinks,
conductances along x, y, z; offsets into the tables, which follow the settings, of decay rates by mode along x, y, z,
and of the length of all transforms, the volume of a cell and the sum of its conductances; the entry of y that tells
what has come in, or -1; 1 where the transforms solve it; the plans of the transforms, flows/layout).
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.flows.fourier_kernels import transform
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
from sceneql.flows.projection_kernels import less_gradient, outflow, project
from sceneql.grids.multigrid.stencil_kernels import dot, multiply
from sceneql.system.signatures_kernels import STEP, A, F, I, N

CHORIN, CNAB2, SBDF2 = range(3)
SCHEME, HAS_BEFORE, OPERATORS, FLOW_AT, VELOCITIES, HEAD = range(6)
START, END, LENGTH, VISCOSITY, TABLES = range(5)
DECAYS, SIZES_AT, TALLY, EXACT, PLANS_AT = 9, 12, 13, 14, 15
OPERATOR = PLANS_AT + 3 * PLAN
ARRAYS = 12
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
    transform(z, nx, ny, nz, True, tables, scratch, plans)
    for k in range(nz):
        deep = tables[op[DECAYS + 2] + k] if nz > 1 else 0.0
        for j in range(ny):
            both = deep + tables[op[DECAYS + 1] + j]
            for i in range(nx):
                z[i + nx * (j + ny * k)] /= tables[op[SIZES_AT]] * (1.0 + a * (both + tables[op[DECAYS] + i]))
    transform(z, nx, ny, nz, False, tables, scratch, plans)
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


@lean_inlined
def given_beside(op, a, x, r, floats):
    """Add what comes over the faces to entries that are given, which in a box stand at the ends of an axis."""
    at_faces = 0
    for axis in range(3):
        at_faces += NODES <= op[PLANS_AT + PLAN * axis + KIND] <= FREE_NODES
    if at_faces == 0:
        return
    counts = op[1:4]
    volume = floats[op[4] : op[4] + x.size]
    for axis in range(2 if op[3] == 1 else 3):
        ties = floats[op[6 + axis] : op[6 + axis] + x.size]
        stride, last = 1, counts[axis] - 1
        for before in range(axis):
            stride *= counts[before]
        rows = x.size // counts[axis]
        for row in range(rows if last > 0 else 0):
            low = (row // stride) * stride * counts[axis] + row % stride
            high = low + last * stride
            if volume[low] == 0.0:
                r[low + stride] += a * ties[low + stride] * x[low]
            if volume[high] == 0.0:
                r[high - stride] += a * ties[high] * x[high]


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
            r[c] = volume[c] * aim[c]
        given_beside(op, a, x, r, floats)
        precondition(r, z, volume, a, tables, scratch, op)
        for c in range(n):
            x[c] = z[c] if volume[c] > 0.0 else x[c]
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
def remember(t, y0, latest, n_before, start, before, end, settings, numbers, settled):
    """Whether this step goes on from the latest, whose start and rates are then those before, or repeats it."""
    if t == settings[END] and (settled or same(y0, end)):
        for k in range(y0.size):
            before[k], n_before[k] = start[k], latest[k]
        settings[LENGTH] = settings[END] - settings[START]
        numbers[HAS_BEFORE] = 1
    elif not (t == settings[START] and same(y0, start)):
        numbers[HAS_BEFORE] = 0
    for k in range(y0.size):
        start[k] = y0[k]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; returns 0."""
    n = y0.size
    rate1, latest, n_before = work[:n], work[n : 2 * n], work[2 * n : 3 * n]
    start, before, end = work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 6 * n]
    wanted, spreading, room, pressure = work[6 * n : 7 * n], work[7 * n : 8 * n], work[8 * n :], work[12 * n :]
    one = numbers[numbers[FLOW_AT] :]
    cells = one[CELLS] * one[CELLS + 1] * one[CELLS + 2]
    q = floats[one[PRESSURE] : one[PRESSURE] + cells]
    scheme = numbers[SCHEME]
    rate = rate_at(functions[AT_RATE])
    settled = floats[channels.SETTLED] != 0.0
    remember(t, y0, latest, n_before, start, before, end, settings, numbers, settled)
    has_before = numbers[HAS_BEFORE] == 1
    if not has_before and t != settings[START]:  # the pressure of the start, or after a change from outside
        rate(t, y0, latest, floats, ints)
        for c in range(cells):
            pressure[c] = q[c]
    elif t == settings[START]:
        for c in range(cells):
            pressure[c] = pressure[cells + c]
    settings[START], settings[END] = t, t + h
    for c in range(cells):
        pressure[cells + c] = pressure[c]
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
    if numbers[VELOCITIES] < numbers[OPERATORS]:
        for k in range(n):
            spreading[k] = 0.0
        spread(y0, spreading, numbers[VELOCITIES], numbers[OPERATORS], floats, numbers)
        for k in range(n):
            latest[k] -= spreading[k]
    first, second, old, new, former = a1 / lead, a2 / lead, before, h * b1 / lead, h * b2 / lead
    if not has_before:
        old, new, former = y0, h * (b1 + b2), 0.0
    for k in range(n):
        wanted[k] = first * y0[k] + second * old[k] + new * latest[k] + former * n_before[k]
    if implicit < 1.0:
        for k in range(n):
            spreading[k] = 0.0
        spread(y0, spreading, 0, numbers[OPERATORS], floats, numbers)
        for k in range(n):
            wanted[k] += h * (1.0 - implicit) * spreading[k]
    if scheme != CHORIN:
        less_gradient(wanted, pressure, h / lead, floats, one)
    for k in range(n):
        y1[k] = wanted[k]
    solved, ahead = True, w if has_before else 0.0
    for number in range(numbers[OPERATORS]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        if op[EXACT] == 0:  # iterations begin with the values that go on as they went
            size = op[1] * op[2] * op[3]
            x, x0, x_before = y1[op[0] : op[0] + size], y0[op[0] : op[0] + size], before[op[0] : op[0] + size]
            for c in range(size):
                x[c] = x0[c] + ahead * (x0[c] - x_before[c]) if floats[op[4] + c] > 0.0 else x[c]
        solved &= solve(
            op, h * implicit / lead, wanted, y1, SMALL, floats, settings[TABLES:], floats[one[WORK] :], room
        )
    if scheme != CHORIN:
        gathered = room[:cells]
        outflow(y1, gathered, VELOCITY, floats, one)
    latest_q = pressure[2 * cells : 3 * cells]  # iterations begin with what the step before took away
    guessed = has_before and one[ITERATES] > 0
    if guessed:
        less_gradient(y1, latest_q, 1.0, floats, one)
    solved &= project(y1, VELOCITY, floats, one)
    if guessed:
        for c in range(cells):
            q[c] += latest_q[c]
    for c in range(cells):
        latest_q[c] = q[c]
    if scheme != CHORIN:
        part, damped = lead / h, implicit * settings[VISCOSITY]
        for c in range(cells):
            pressure[c] += q[c] * part - damped * gathered[c]
    for number in range(numbers[OPERATORS]):
        tally(numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)], y0, y1, floats)
    bend = w / (1.0 + w) if has_before else 0.0
    slope, before_slope = (1.0 + bend) / h, -bend / settings[LENGTH] if has_before else 0.0
    for k in range(n):
        rate1[k] = slope * (y1[k] - y0[k]) + before_slope * (y0[k] - old[k])
    for k in range(n):
        end[k] = y1[k]
    if not solved:
        y1[one[AT]] = math.nan
    return 0.0
