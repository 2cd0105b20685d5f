# mypy: ignore-errors
"""A step that is explicit in advection and implicit in viscosity and diffusion, then projected.

lead u1 = a1 u0 + a2 u_before + h (b1 N0 + b2 N_before) + h L (implicit u* + explicit u0) - h grad p, where L is the sum
over faces of g (neighbor - u) of every field whose g do not vary, and N all other rates, unprojected. u1 is u* without
its divergence; the pressure grows by what that takes away, less viscosity times the divergence (Brown, Cortez & Minion
2001, J. Comput. Phys. 168, 464-499; Guermond & Shen 2004, Math. Comp. 73, 1719-1737), or is left out (Chorin 1968).

``settings``: start and end of the latest step, length of the one before it, viscosity, 1 where the rate at a step's end
is asked for between steps; then the tables. ``numbers``: [scheme, 1 if there is a step before, how often a step went on
from the one before, number of operators, where the flow's integers begin, operators of velocities, which come first],
then the operators (operators_kernels).

Arrays of the state's size are passed over as seldom as may be: each pass does all it can to a band of rows that the
cache holds, since larger states are as slow as memory is.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.flows.layout import (
    AREAS,
    AT,
    AXES,
    CELLS,
    FACES,
    ITERATES,
    PERIODIC,
    PRESSURE,
    SCALES,
    SKIP,
    VELOCITY,
    WORK,
)
from sceneql.flows.projection_kernels import (
    by_transform,
    first_face,
    less_gradient,
    lessen_row,
    outflow,
    outflow_row,
    project,
    pushed_at,
    rid,
)
from sceneql.flows.schemes.operators_kernels import (
    EXACT,
    HEAD,
    OPERATOR,
    OPERATORS,
    add_spread,
    by_modes,
    same,
    solve,
    tally,
)
from sceneql.system.signatures_kernels import DENSE, STEP, A, F, I

CHORIN, CNAB2, SBDF2 = range(3)
SCHEME, HAS_BEFORE, TURN, _, FLOW_AT, VELOCITIES = range(HEAD)
START, END, LENGTH, VISCOSITY, RATES, TABLES = range(6)
GOES_ON, REPEATS, BEGINS = range(3)
ARRAYS = 11
SMALL = 1e-10
"""Residual of implicit parts, in parts of the right side."""
BAND = 4096
"""Cells of a band of rows."""


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
    rows = max(1, BAND // ints[CELLS])
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
    """What flows out of cells, and the same less than 0, which becomes the pressure."""
    nx, ny, faces = ints[CELLS], ints[CELLS + 1], ints[FACES]
    u, areas = y1[ints[AT] : ints[AT] + faces], floats[ints[AREAS] : ints[AREAS] + faces]
    pushed = pushed_at(VELOCITY, ints)
    for k in range(ints[CELLS + 2]):
        for j in range(ny):
            row = nx * (j + ny * k)
            own, less = gathered[row : row + nx], q[row : row + nx]
            outflow_row(u, areas, own, j, k, ints)
            if pushed >= 0:
                for i in range(nx):
                    own[i] -= floats[pushed + row + i]
            for i in range(nx):
                less[i] = -own[i]


@lean(types.void(A, A, A, A, A, A, F, F, A, I), inner=True)
def finish(y1, end, q, gathered, pressure, pressure_after, part, damped, floats, ints):
    """Take the gradient of q from y1, which is then remembered in ``end``, and put the pressure forward."""
    at, faces, nx, ny = ints[AT], ints[FACES], ints[CELLS], ints[CELLS + 1]
    u, scales = y1[at : at + faces], floats[ints[SCALES] : ints[SCALES] + faces]
    for c in range(at):
        end[c] = y1[c]
    for c in range(at + faces, y1.size):
        end[c] = y1[c]
    rows = max(1, BAND // nx)
    for k in range(ints[CELLS + 2]):
        for j in range(0, ny, rows):
            last = min(ny, j + rows)
            for row in range(j, last):
                lessen_row(u, scales, q, 1.0, row, k, ints)
            for number in range(ints[AXES] + 1):
                begin, count = piece(number, j, last, k, ints)
                for f in range(at + begin, at + begin + count):
                    end[f] = y1[f]
            for c in range(nx * (j + ny * k), nx * (last + ny * k)):
                pressure_after[c] = pressure[c] + (q[c] * part - damped * gathered[c])


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The parabola through the ends of the step and of the one before it: order 2; a line in the first step."""
    n = y0.size
    w = h / settings[LENGTH] if numbers[HAS_BEFORE] == 1 else 0.0
    before = work[n + (numbers[TURN] + 2) % 3 * n :]
    bend = theta * (theta - 1.0) * w / (1.0 + w)
    for k in range(n):
        change = y1[k] - y0[k]
        out[k] = y0[k] + theta * change + bend * (change - w * (y0[k] - before[k]))


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
    settled = floats[channels.SETTLED] != 0.0 or settings[RATES] == 0.0
    how = remember(t, y0, start, before, states[(turn + 1) % 3 * n :], settings, numbers, settled)
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
    if not has_before:
        first, second, new, former = first + second, 0.0, new + former, 0.0
    known, known_rate = (before, n_before) if has_before else (y0, latest)
    push = h / lead if scheme != CHORIN else 0.0
    factors = (first, second, new, former)
    explicit(y1, y0, known, latest, known_rate, factors, pressure, push if implicit == 1.0 else 0.0, floats, one)
    if implicit < 1.0:
        add_spread(y0, y1, h * (1.0 - implicit), 0, spreading, floats, numbers)
        less_gradient(y1, pressure, push, floats, one)
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
    part, damped = lead / h, implicit * settings[VISCOSITY]
    if one[ITERATES] > 0:
        outflow(y1, gathered, VELOCITY, floats, one)
        if has_before:  # iterations begin with what the step before took away
            less_gradient(y1, latest_q, 1.0, floats, one)
            solved &= project(y1, VELOCITY, floats, one)
            for c in range(cells):
                q[c] += latest_q[c]
        else:
            for c in range(cells):
                q[c] = -gathered[c]
            solved &= rid(y1, VELOCITY, floats, one)
        for c in range(cells):
            latest_q[c] = q[c]
            pressure_after[c] = pressure[c] + (q[c] * part - damped * gathered[c])
    else:
        gather(y1, gathered, q, floats, one)
        by_transform(q, floats, one)
    for number in range(numbers[OPERATORS]):
        tally(numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)], y0, y1, floats)
    if one[ITERATES] > 0:
        for k in range(n):
            end[k] = y1[k]
    else:
        finish(y1, end, q, gathered, pressure, pressure_after, part, damped, floats, one)
    if settings[RATES] != 0.0:
        bend = w / (1.0 + w) if has_before else 0.0
        slope, slope_before = (1.0 + bend) / h, -bend / settings[LENGTH] if has_before else 0.0
        for k in range(n):
            rate1[k] = slope * (y1[k] - y0[k]) + slope_before * (y0[k] - known[k])
    if not solved:
        y1[one[AT]] = math.nan
    return 0.0
