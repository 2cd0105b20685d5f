# mypy: ignore-errors
"""One step of any singly diagonally implicit Runge-Kutta method (SDIRK): the tableau is data.

``settings``: the memory of Newton's method (newton_kernels), then the diagonal g, c (s), b (s), b - b_hat (s), the rows
of a below the diagonal, packed; then the scales of the stage plan. ``numbers``: [stages, 1 if the first is explicit,
1 if y1 is the last stage, 1 if there is an embedded method, order of its error, where the scales start, entries of the
Jacobian's room], then the stage plan. ``work``: the step to try next, in an array of y's size; the s slopes k; four
arrays of scratch; the Jacobian; the store of the stage plan.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_LIMIT
from sceneql.linear.newton_kernels import CAREFUL, FACTORED, MEMORY, newton, norm
from sceneql.linear.stage_kernels import solve_stage
from sceneql.system.signatures_kernels import DENSE, STEP

STAGES, EXPLICIT_FIRST, STIFFLY_ACCURATE, EMBEDDED, ERROR_ORDER, SCALES_AT, ROOM, HEAD = range(8)
KEPT = 1.2
"""Increase of the step below which a new factorization does not pay."""


@lean_inlined
def add_slopes(settings, at, count, h, y0, work, out):
    """out = y0 + h times the sum of the first slopes, weighted by settings[at:]."""
    n = y0.size
    for k in range(n):
        out[k] = y0[k]
    for j in range(count):
        weight = h * settings[at + j]
        if weight != 0.0:
            slope = work[(1 + j) * n : (2 + j) * n]
            for k in range(n):
                out[k] += weight * slope[k]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the embedded error, filtered by the stage system (Hosea & Shampine 1996)."""
    n, stages = y0.size, numbers[STAGES]
    base, scratch = work[:n], work[(1 + stages) * n : (5 + stages) * n]
    jacobian = work[(5 + stages) * n : (5 + stages) * n + numbers[ROOM]]
    store = work[(5 + stages) * n + numbers[ROOM] :]
    scales, plan = settings[numbers[SCALES_AT] :], numbers[HEAD:]
    diagonal = settings[MEMORY]
    c = MEMORY + 1
    b, e, row = c + stages, c + 2 * stages, c + 3 * stages
    a = h * diagonal
    first = numbers[EXPLICIT_FIRST]
    slope = work[n : 2 * n]
    # Unless the method is stiffly accurate, stiff components keep ringing: the rate at the start is a poor guess.
    if first == 1 or numbers[STIFFLY_ACCURATE] == 1 or settings[FACTORED] == 0.0:
        for k in range(n):
            slope[k] = rate0[k]
    # Where skins touch the guess is the state before, in which what sticks is at rest: accelerations would move it.
    touches = functions[AT_LIMIT] != 0 and settings[CAREFUL] > 0.0
    if touches:
        for k in range(n):
            y1[k] = y0[k]
    for i in range(first, stages):
        add_slopes(settings, row, i, h, y0, work, base)
        row += i
        if not touches:
            for k in range(n):
                y1[k] = base[k] + a * slope[k]
        if not newton(
            functions, t + settings[c + i] * h, a, base, y0, y1, scratch, jacobian, store, scales,
            settings, plan, floats, ints,
        ):  # fmt: skip
            work[0] = 0.25 * h
            return math.inf
        slope = work[(1 + i) * n : (2 + i) * n]
        for k in range(n):
            slope[k] = (y1[k] - base[k]) / a
    if numbers[STIFFLY_ACCURATE] == 0:
        add_slopes(settings, b, stages, h, y0, work, y1)
    if numbers[EMBEDDED] == 0:
        return 0.0
    wrong = scratch[:n]
    for k in range(n):
        wrong[k] = 0.0
    for j in range(stages):
        weight = h * settings[e + j]
        slope = work[(1 + j) * n : (2 + j) * n]
        for k in range(n):
            wrong[k] += weight * slope[k]
    solve_stage(plan, a, jacobian, scales, store, wrong)
    error = norm(wrong, y0, y1, settings)
    factor = min(5.0, max(0.2, 0.9 * max(error, 1e-8) ** (-1.0 / numbers[ERROR_ORDER])))
    work[0] = h if 1.0 <= factor <= KEPT else h * factor
    return error


@lean(DENSE)
def linear(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """Linear dense output: the collocation polynomial of a method of one stage."""
    for k in range(y0.size):
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k]
