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
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.compiled.vectors_kernels import same
from sceneql.flows.layout import AT, CELLS, ITERATES, PRESSURE, SKIP, VELOCITY, WORK
from sceneql.flows.projection_kernels import by_transform_of_rows, less_gradient, outflow, project, rid
from sceneql.flows.schemes.bands_kernels import explicit, finish, gather
from sceneql.flows.schemes.operators_kernels import (
    EXACT,
    HEAD,
    ODD,
    OPERATOR,
    OPERATORS,
    add_spread,
    by_modes,
    solve,
    tally,
)
from sceneql.system.signatures_kernels import DENSE, STEP

CHORIN, CNAB2, SBDF2 = range(3)
SCHEME, HAS_BEFORE, TURN, _, FLOW_AT, VELOCITIES = range(HEAD)
START, END, LENGTH, VISCOSITY, RATES, TABLES = range(6)
GOES_ON, REPEATS, BEGINS = range(3)
ARRAYS = 11
SMALL = 1e-10
"""Residual of implicit parts, in parts of the right side."""


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
    pressures = work[ARRAYS * n : ARRAYS * n + 4 * cells]
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
        for c in range(size):
            aim[c] = x[c]
        if op[ODD] < 0:  # iterations begin with the values that go on as they went
            for c in range(size):
                x[c] = x0[c] + ahead * (x0[c] - x_before[c]) if volume[c] > 0.0 else x[c]
        solved &= solve(op, h * implicit / lead, wanted, y1, SMALL, floats, tables, floats[one[WORK] :], room)
    gathered, latest_q, guess = room[:cells], pressures[2 * cells : 3 * cells], pressures[3 * cells :]
    part, damped = lead / h, implicit * settings[VISCOSITY]
    if one[ITERATES] > 0:
        outflow(y1, gathered, VELOCITY, floats, one)
        if has_before:  # iterations begin with what steps before took away, as that goes on
            less_gradient(y1, guess, 1.0, floats, one)
            solved &= project(y1, VELOCITY, floats, one)
            for c in range(cells):
                q[c] += guess[c]
        else:
            for c in range(cells):
                q[c] = -gathered[c]
            solved &= rid(y1, VELOCITY, floats, one)
        for c in range(cells):
            guess[c] = q[c] + (q[c] - latest_q[c] if has_before else 0.0)
            latest_q[c] = q[c]
            pressure_after[c] = pressure[c] + (q[c] * part - damped * gathered[c])
    else:
        gather(y1, gathered, q, floats, one)
        by_transform_of_rows(q, floats, one)
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
