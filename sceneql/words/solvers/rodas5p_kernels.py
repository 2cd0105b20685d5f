# mypy: ignore-errors
"""One step of a Rosenbrock method in the form that needs no product with the Jacobian (Hairer & Wanner 1996, IV.7).

(1/(g h) - J) u_i = f(t + c_i h, y0 + sum a_ij u_j) + sum C_ij/h u_j + d_i h df/dt; the last two stages start from the
one before, and y1 is the last of these states plus u_s, which is also the error.

``settings``: relative and absolute tolerance, g, c (s), d (s), rows of a (s - 2) and of C (s) below the diagonal,
packed, the dense output's H (3 s); the scales of the stage plan; those of error_scales_kernels. ``numbers``: [stages,
where the scales of the stage plan start, entries of the Jacobian's room, where the other scales start, length of the
plan of error_scales_kernels, which is 0 where an absolute tolerance is given], then that plan, the stage plan.
``work``: the rate at the end, the s stages, two arrays of scratch, the weights of entries in the error; the Jacobian;
the store of the stage plan.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_JACOBIAN, AT_RATE, jacobian_at, rate_at
from sceneql.linear.newton_kernels import fail
from sceneql.linear.stage_kernels import TALLIES, TALLIES_AT, factor_stage, solve_stage
from sceneql.stepping.error_scales_kernels import foresee, level, shaken, weigh_anew
from sceneql.system.signatures_kernels import DENSE, STEP

STAGES, SCALES_AT, ROOM, SIZES_AT, SCALED, HEAD = range(6)
RELATIVE, ABSOLUTE, GAMMA = range(3)
LOBATTO = 0.27639320225002106
"""(1 - 1/sqrt 5)/2: the inner nodes of Lobatto's quadrature, order 6, stand there and at 1 less that."""


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The fourth-order interpolant of Rodas5P (Steinebach 2023); of tallies, the cubic one of Hermite."""
    n, stages = y0.size, numbers[STAGES]
    at = numbers[SCALES_AT] - 3 * stages
    for k in range(n):
        first = second = third = 0.0
        for j in range(stages):
            u = work[(1 + j) * n + k]
            first += settings[at + j] * u
            second += settings[at + stages + j] * u
            third += settings[at + 2 * stages + j] * u
        bend = (1.0 - theta) * (first + theta * (second + theta * third))
        out[k] = (1.0 - theta) * y0[k] + theta * (y1[k] + bend)
    plan = numbers[HEAD + numbers[SCALED] :]
    at = plan[TALLIES_AT]
    for place in range(at, at + plan[TALLIES]):
        k = plan[place]
        change = y1[k] - y0[k]
        bend = (1.0 - 2.0 * theta) * change + (theta - 1.0) * h * rate0[k] + theta * h * rate1[k]
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k] + theta * (theta - 1.0) * bend


@lean_inlined
def time_slope(rate, t, y0, rate0, out, floats, ints):
    """df/dt by a forward difference."""
    move = math.sqrt(2.2e-16 * max(1e-5, abs(t)))
    moved = t + move
    rate(moved, y0, out, floats, ints)
    for k in range(y0.size):
        out[k] = (out[k] - rate0[k]) / (moved - t)


@lean_inlined
def tally(plan, base, weight, rate, y):
    """y = base + weight * rate on the tallies: entries whose derivatives by the others are unknown."""
    at = plan[TALLIES_AT]
    for k in range(at, at + plan[TALLIES]):
        y[plan[k]] = base[plan[k]] + weight * rate[plan[k]]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the error in the norm of Hairer, Norsett & Wanner (1993, eq. II.4.11)."""
    rate, slopes = rate_at(functions[AT_RATE]), jacobian_at(functions[AT_JACOBIAN])
    n, stages = y0.size, numbers[STAGES]
    stages_end = (1 + stages) * n
    last, drift, sample = work[:n], work[stages_end : stages_end + n], work[stages_end + n : stages_end + 2 * n]
    weights = work[stages_end + 2 * n : stages_end + 3 * n]
    jacobian = work[stages_end + 3 * n : stages_end + 3 * n + numbers[ROOM]]
    store = work[stages_end + 3 * n + numbers[ROOM] :]
    scales, plan = settings[numbers[SCALES_AT] :], numbers[HEAD + numbers[SCALED] :]
    a = settings[GAMMA] * h
    c, d = 3, 3 + stages
    row, inner = 3 + 2 * stages, 3 + 2 * stages + (stages - 2) * (stages - 3) // 2
    slopes(functions, t, y0, jacobian, floats, ints)
    if not factor_stage(plan, a, jacobian, scales, store):
        fail(rate0, y1)
        return math.inf
    time_slope(rate, t, y0, rate0, drift, floats, ints)
    for k in range(n):
        y1[k] = y0[k]
    for i in range(stages):
        u = work[(1 + i) * n : (2 + i) * n]
        before = work[i * n : (1 + i) * n]
        if 0 < i < stages - 2:
            for k in range(n):
                y1[k] = y0[k]
            for j in range(i):
                weight = settings[row + j]
                for k in range(n):
                    y1[k] += weight * work[(1 + j) * n + k]
            row += i
        elif i > 0:
            for k in range(n):
                y1[k] += before[k]
        if i > 0:
            rate(t + settings[c + i] * h, y1, u, floats, ints)
        else:
            for k in range(n):
                u[k] = rate0[k]
        for j in range(i):
            weight = settings[inner + j] / h
            for k in range(n):
                u[k] += weight * work[(1 + j) * n + k]
        inner += i
        weight = settings[d + i] * h
        for k in range(n):
            u[k] = a * (u[k] + weight * drift[k])
        if not solve_stage(plan, a, jacobian, scales, store, u):
            fail(u, y1)
            return math.inf
    u = work[stages * n : stages_end]
    total = 0.0
    for k in range(plan[TALLIES]):
        u[plan[plan[TALLIES_AT] + k]] = 0.0
    for k in range(n):
        y1[k] += u[k]
    if numbers[SCALED] > 0:
        sizes, groups = settings[numbers[SIZES_AT] :], numbers[HEAD:]
        foresee(functions, t, h, y0, rate0, sizes, groups, sample, drift, floats, ints)
        if weigh_anew(t, settings[RELATIVE], h, y0, rate0, sample, sizes, groups, weights):
            shaken(functions, t, y0, rate0, sizes, groups, drift, sample, floats, ints)
            if solve_stage(plan, a, jacobian, scales, store, drift):
                level(h, drift, sizes, groups, weights)
    else:
        for k in range(n):
            weights[k] = 1.0 / (settings[ABSOLUTE] + settings[RELATIVE] * max(abs(y0[k]), abs(y1[k])))
    for k in range(n):
        part = u[k] * weights[k]
        total += part * part
    rate(t + h, y1, last, floats, ints)
    if plan[TALLIES] > 0:
        tally(plan, y0, h / 12.0, rate0, y1)
        for node in (LOBATTO, 1.0 - LOBATTO):
            dense(node, h, y0, rate0, y1, last, work, settings, numbers, sample)
            rate(t + node * h, sample, drift, floats, ints)
            tally(plan, y1, 5.0 * h / 12.0, drift, y1)
        tally(plan, y1, h / 12.0, last, y1)
    return math.sqrt(total / n)
