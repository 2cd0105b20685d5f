# mypy: ignore-errors
"""A step of an additive Runge-Kutta pair on a flow: explicit in advection, implicit in viscosity and diffusion.

Stage i solves Y_i - a P L Y_i = P (y0 + h sum over j < i of (e_ij N_j + d_ij L Y_j)), a = h d_ii, with L and N as in
multistep_kernels and P the projection. So the pressure keeps to each stage, and beside walls the order stays. The
velocities are found by conjugate gradients among those free of divergence, with P (1 - a L)^-1 as preconditioner.

The end of a step is the last stage Y_s, which has the weights b of the implicit rates, and h sum (b_j - e_sj) N_j. Of
this second part, which no stage has solved for, what is fast is taken away (``quiet``).

``settings``: the tableau (e, d, b, b - b of the embedded method, nodes), the tolerance, then the size that each block
of the state has had, 1 where the latest step went on from the one before, its end, and the tables. ``numbers``:
[stages, where the flow's integers begin, number of blocks, operators of velocities, operators, where in the settings
the tables begin], the operators, [offset in y, count] of each block, whose errors are measured together, the flow's
integers.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.compiled.vectors_kernels import same
from sceneql.flows.layout import AT, CHANGE, FACES, INVERSES, LED, RATE, SKIP, VELOCITY, WORK
from sceneql.flows.projection_kernels import project
from sceneql.flows.schemes.operators_kernels import OPERATOR, solve, spread, tally
from sceneql.system.signatures_kernels import DENSE, STEP, A, F, I, N

STAGES, FLOW_AT, BLOCKS, AXES, OPERATORS, TABLES_AT, HEAD = range(7)
EXACT, SHARE = 1e-10, 1e-3
"""Residual of a stage's velocities, in parts of their size, and of the tolerance, whichever is larger."""
FINE, COARSE = 1e-12, 1e-3
"""Residuals of systems without projection, those of the preconditioner the second."""
ROUNDING = 1e-14
"""Residual, in parts of velocities before they lose their divergence, that may be rounding of what that takes away: of
fluid that rests under a pressure nothing else is left."""
MOST, LEAST = 30, 1e3
"""Iterations of a stage; how many times the residual asked for may be left then."""


@lean(types.float64(N, A, A, A, I), inner=True)
def product(axes, x, y, floats, numbers):
    """Inner product of velocities, by the volumes of their own cells."""
    total = 0.0
    for number in range(axes):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        for c in range(op[1] * op[2] * op[3]):
            total += floats[op[4] + c] * x[op[0] + c] * y[op[0] + c]
    return total


@lean(types.boolean(F, F, F, A, A, A, A, A, A, I), inner=True)
def implicit(a, exact, rounded, wanted, y, room, more, floats, tables, numbers):
    """Solve Y - a P L Y = wanted in y; wanted is free of divergence; ``exact``: the residual, in parts of y, and
    ``rounded`` the square of one that is rounding.

    Whether it was reached. ``room``, ``more``: 4 arrays of y's size each.
    """
    n = y.size
    one = numbers[numbers[FLOW_AT] :]
    first, last = one[AT], one[AT] + one[FACES]
    axes = numbers[AXES]
    for number in range(numbers[OPERATORS]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        if not solve(op, a, wanted, y, FINE, floats, tables, floats[one[WORK] :], room):
            return False
    if axes == 0:
        return True
    solved = project(y, VELOCITY, floats, one)
    r, z, p, q = more[:n], more[n : 2 * n], more[2 * n : 3 * n], more[3 * n : 4 * n]
    for k in range(first, last):
        q[k] = 0.0
    spread(y, q, 0, axes, floats, numbers)
    solved &= project(q, CHANGE, floats, one)
    for k in range(first, last):
        r[k] = wanted[k] - y[k] + a * q[k]
    whole = product(axes, y, y, floats, numbers)
    before = 0.0
    for count in range(MOST + 1):
        enough = exact if count < MOST else LEAST * exact
        left = product(axes, r, r, floats, numbers)
        if not left > enough * enough * whole + rounded:
            return solved and left <= enough * enough * whole + rounded
        if count == MOST:
            break
        for k in range(first, last):
            z[k] = r[k]
        for number in range(axes):
            op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
            solve(op, a, r, z, COARSE, floats, tables, floats[one[WORK] :], room)
        solved &= project(z, CHANGE, floats, one)
        now = product(axes, r, z, floats, numbers)
        part = now / before if count > 0 else 0.0
        for k in range(first, last):
            p[k] = z[k] + part * p[k]
        spread(p, q, 0, axes, floats, numbers)
        solved &= project(q, CHANGE, floats, one)
        for k in range(first, last):
            q[k] = p[k] - a * q[k]
        length = now / product(axes, p, q, floats, numbers)
        for k in range(first, last):
            y[k] += length * p[k]
            r[k] -= length * q[k]
        before = now
    return False


@lean(types.boolean(F, F, A, A, A, A, A, A, I), inner=True)
def quiet(a, exact, still, y, room, more, floats, tables, numbers):
    """Take what is fast from y - still, of velocities, where y has more than ``still``, the last stage: in place.

    By (1 - a L)^-1, and once more of what that took away, so that what is slow stays up to (a L)^2 and the order with
    it. What is fast would be small, but the forces on walls are it times conductances without a bound, and so would be
    the errors that are measured. Whether it was solved; y has a divergence then.
    """
    n, solved = y.size, True
    scratch = floats[numbers[numbers[FLOW_AT] + WORK] :]
    change, slow, rest, more_slow = more[:n], more[n : 2 * n], more[2 * n : 3 * n], more[3 * n : 4 * n]
    for number in range(numbers[AXES]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        first, last = op[0], op[0] + op[1] * op[2] * op[3]
        for k in range(first, last):
            change[k] = slow[k] = y[k] - still[k]
        solved &= solve(op, a, change, slow, exact, floats, tables, scratch, room)
        for k in range(first, last):
            rest[k], more_slow[k] = change[k] - slow[k], 0.0
        solved &= solve(op, a, rest, more_slow, exact, floats, tables, scratch, room)
        for k in range(first, last):
            y[k] = still[k] + slow[k] + more_slow[k]
    return solved


@lean(types.float64(A, A, A, F, A, I), inner=True)
def worst_error(wrong, y0, y1, tolerance, sizes, numbers):
    """The error ``wrong`` of a step from y0 to y1, in parts of what each block may have; ``sizes`` of blocks go on.

    Infinite where it is not finite.
    """
    worst = 0.0
    for block in range(numbers[BLOCKS]):
        place = numbers[FLOW_AT] - 2 * numbers[BLOCKS] + 2 * block
        at, count = numbers[place], numbers[place + 1]
        total = 0.0
        size, had = sizes[block], sizes[block]
        for k in range(at, at + count):
            total += wrong[k] * wrong[k]
            had = max(had, abs(y0[k]))
            size = max(size, abs(y0[k]), abs(y1[k]))
        if not math.isfinite(total):
            return math.inf
        # What grows out of nothing, as t^2, has the same error at any length of its first step in parts of what it is.
        part = tolerance if had > 0.0 else 1.0
        if size > 0.0 and count > 0:
            worst = max(worst, math.sqrt(total / count) / (part * size))
    if worst <= 1.0:
        for block in range(numbers[BLOCKS]):
            place = numbers[FLOW_AT] - 2 * numbers[BLOCKS] + 2 * block
            for k in range(numbers[place], numbers[place] + numbers[place + 1]):
                sizes[block] = max(sizes[block], abs(y1[k]))
    return worst


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The cubic through the ends of the step and its rates there; in a step that begins, without the rate at its start,
    which may be that of walls set moving at once, a parabola."""
    goes_on = settings[numbers[TABLES_AT] - 2] == 1.0
    for k in range(y0.size):
        change = y1[k] - y0[k]
        first = h * rate0[k] if goes_on else 2.0 * change - h * rate1[k]
        bend = (1.0 - 2.0 * theta) * change + (theta - 1.0) * first + theta * h * rate1[k]
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k] + theta * (theta - 1.0) * bend


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; its error by the embedded method."""
    n, s = y0.size, numbers[STAGES]
    rate1, end, end_rate = work[:n], work[n : 2 * n], work[2 * n : 3 * n]
    wanted, spreading, room, more = work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 9 * n], work[9 * n : 13 * n]
    explicit, damped = work[13 * n : (13 + s) * n], work[(13 + s) * n : (13 + 2 * s) * n]
    e, d = settings[: s * s], settings[s * s : 2 * s * s]
    b, wrong, nodes = settings[2 * s * s :], settings[2 * s * s + s :], settings[2 * s * s + 2 * s :]
    latest, tables, velocities = numbers[TABLES_AT] - 1, settings[numbers[TABLES_AT] :], numbers[AXES]
    tolerance, sizes = settings[2 * s * s + 3 * s], settings[2 * s * s + 3 * s + 1 :]
    one = numbers[numbers[FLOW_AT] :]
    rate = rate_at(functions[AT_RATE])
    first, last = one[AT], one[AT] + one[FACES]
    floats[one[SKIP]] = 1.0
    solved, goes_on = True, settings[latest] == t and same(y0, end)
    settings[latest - 1] = 1.0 if goes_on else 0.0
    for i in range(s):
        own, mine = explicit[i * n : (i + 1) * n], damped[i * n : (i + 1) * n]
        if i == 0:
            for k in range(n):
                y1[k] = y0[k]
        else:
            for k in range(n):
                total = 0.0
                for j in range(i):
                    total += e[i * s + j] * explicit[j * n + k] + d[i * s + j] * damped[j * n + k]
                wanted[k] = y0[k] + h * total
            if one[LED] > 0:  # solids are where they are at the stage
                rate(t + nodes[i] * h, wanted, own, floats, ints)
            rounded = ROUNDING**2 * product(velocities, wanted, wanted, floats, numbers)
            solved &= project(wanted, VELOCITY, floats, one)
            for k in range(n):
                y1[k] = wanted[k]
            a, exact = h * d[i * s + i], max(EXACT, SHARE * tolerance)
            solved &= implicit(a, exact, rounded, wanted, y1, room, more, floats, tables, numbers)
        if i == 0 and one[LED] == 0 and goes_on:
            for k in range(n):
                own[k] = end_rate[k]
        else:
            rate(t + nodes[i] * h, y1, own, floats, ints)
        if i == 0 and one[LED] > 0:
            for f in range(one[FACES]):
                spreading[f] = floats[one[INVERSES] + f]
        for k in range(n):
            mine[k] = 0.0
        spread(y1, mine, velocities, numbers[OPERATORS], floats, numbers)
        for k in range(n):
            own[k] -= mine[k]
        spread(y1, mine, 0, velocities, floats, numbers)
    for k in range(n):
        end[k] = y1[k]
        total = error = beyond = 0.0
        for j in range(s):
            both = explicit[j * n + k] + damped[j * n + k]
            total += b[j] * both
            error += wrong[j] * both
            beyond += (b[j] - e[(s - 1) * s + j]) * explicit[j * n + k]
        y1[k] = y1[k] + h * beyond if first <= k < last else y0[k] + h * total
        wanted[k] = h * error
    solved &= project(y1, VELOCITY, floats, one) and project(wanted, CHANGE, floats, one)
    solved &= quiet(h * d[s * s - 1], max(EXACT, SHARE * tolerance), end, y1, room, more, floats, tables, numbers)
    solved &= project(y1, VELOCITY, floats, one)
    for number in range(numbers[OPERATORS]):
        tally(numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)], y0, y1, floats)
    rate(t + h, y1, end_rate, floats, ints)
    if one[LED] > 0:  # what solids leave in a step or come to has a velocity of theirs then, and no order
        for f in range(one[FACES]):
            if spreading[f] == 0.0 or floats[one[INVERSES] + f] == 0.0:
                wanted[one[AT] + f] = 0.0
    floats[one[SKIP]] = 0.0
    for k in range(n):
        end[k], spreading[k] = y1[k], 0.0
    spread(y1, spreading, 0, velocities, floats, numbers)
    for k in range(n):
        rate1[k] = end_rate[k] + spreading[k]
    settings[latest] = t + h
    if not (project(rate1, RATE, floats, one) and solved):
        y1[one[AT]] = math.nan
    return worst_error(wanted, y0, y1, tolerance, sizes, numbers)
