# mypy: ignore-errors
"""One step of the three-stage Radau IIA method, with its Newton iteration, error estimate and step control.

The stages z_i = Y_i - y0 solve z = h A F(z). With T diagonalizing the inverse of A, w = T^-1 z, a Newton iteration
needs one real and one complex system of the size of y: (g/h - J) and ((a + i b)/h - J). Source: Hairer & Wanner,
Solving Ordinary Differential Equations II (1996), IV.8; predictive control by Gustafsson (1994).

``settings``, ``numbers`` and ``work``: see radau_stages_kernels.py.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.pointers_kernels import AT_JACOBIAN, jacobian_at
from sceneql.stepping import radau_layout as layout
from sceneql.stepping import radau_stages_kernels as stages
from sceneql.stepping.error_scales_kernels import foresee, level, shaken, weigh
from sceneql.stepping.radau_stages_kernels import C1, C2
from sceneql.stepping.radau_systems_kernels import REAL, factor_at, filter_at
from sceneql.system.signatures_kernels import DENSE, STEP, A, F, I

FINISH = types.void(I, F, F, A, A, I, A, I, A, A)
finish_tallies = lazy("sceneql.stepping.radau_tallies_kernels:finish_tallies", FINISH)

SAFETY = 0.9
E1, E2, E3 = (-13.0 - 7.0 * stages.ROOT6) / 3.0, (-13.0 + 7.0 * stages.ROOT6) / 3.0, -1.0 / 3.0

INSIDE = 0.01826
"""Largest |s (s - C1) (s - C2) (s - 1)| for s from 0 to 1."""


@lean_inlined
def begin(t, y0, work, start, z, before):
    """Record the outcome of the try before, and whether its stages can be extrapolated. True: y0 is a new start."""
    n = y0.size
    same = work[layout.BEGUN] > 0.0 and t == work[layout.START]
    follows = work[layout.BEGUN] > 0.0 and not same
    for k in range(n):
        same = same and y0[k] == start[k]
        follows = follows and y0[k] == start[k] + z[2 * n + k]
    if same:
        return False
    work[layout.REJECTED] = 0.0
    work[layout.FRESH] = 0.0
    if follows:
        for k in range(3 * n):
            before[k] = z[k]
        work[layout.BEFORE] = work[layout.LENGTH]
        work[layout.GOOD_LENGTH] = work[layout.LENGTH]
        work[layout.GOOD_ERROR] = max(0.01, work[layout.ERROR])
    else:
        work[layout.BEFORE] = 0.0
        work[layout.GOOD_LENGTH] = 0.0
        work[layout.CONTRACTION] = 1.0
        work[layout.CONVERGENCE] = 1.0
    for k in range(n):
        start[k] = y0[k]
    work[layout.BEGUN] = 1.0
    work[layout.START] = t
    return True


@lean_inlined
def guess_stages(n, ratio, known, z, before, w, ahead):
    """Stages by the polynomial of the step before, or zero; w = T^-1 z; ``ahead`` (n,): the last stage as guessed."""
    if not known:
        for k in range(3 * n):
            z[k] = 0.0
            w[k] = 0.0
        return
    for k in range(n):
        z3 = before[2 * n + k]
        first = (before[n + k] - z3) / (C2 - 1.0)
        inner = (before[k] - before[n + k]) / (C1 - C2)
        second = (inner - first) / (C1 - 1.0)
        third = second - (inner - before[k] / C1) / C2
        s1, s2 = C1 * ratio, C2 * ratio
        a = s1 * (first + (s1 - C2 + 1.0) * (second + (s1 - C1 + 1.0) * third))
        b = s2 * (first + (s2 - C2 + 1.0) * (second + (s2 - C1 + 1.0) * third))
        c = ratio * (first + (ratio - C2 + 1.0) * (second + (ratio - C1 + 1.0) * third))
        z[k] = a
        z[n + k] = b
        z[2 * n + k] = c
        ahead[k] = c
        w[k] = stages.I11 * a + stages.I12 * b + stages.I13 * c
        w[n + k] = stages.I21 * a + stages.I22 * b + stages.I23 * c
        w[2 * n + k] = stages.I31 * a + stages.I32 * b + stages.I33 * c


@lean_inlined
def tallies_move(numbers, n, z):
    """Whether any tally changes in the step."""
    for k in range(layout.HEAD, layout.HEAD + numbers[layout.TALLIES]):
        i = numbers[k]
        if z[i] != 0.0 or z[n + i] != 0.0 or z[2 * n + i] != 0.0:
            return True
    return False


@lean_inlined
def norm(x, weights):
    """Root mean square in units of the tolerance."""
    total = 0.0
    for k in range(x.size):
        part = x[k] * weights[k]
        total += part * part
    return math.sqrt(total / x.size)


@lean_inlined
def estimate(h, rate0, work, numbers, plan, rows, z, f, weights, values, store):
    """The error in units of the tolerance, by the embedded third-order formula, filtered by (REAL/h - J)^-1."""
    n = weights.size
    error = f[:n]
    for k in range(n):
        error[k] = rate0[k] + (E1 * z[k] + E2 * z[n + k] + E3 * z[2 * n + k]) / h
    if not filter_at(numbers[layout.FILTER])(plan, work[layout.FACTORED], values, rows, store, error):
        return math.inf
    return norm(error, weights)


@lean_inlined
def unevenness(ratio, z, ahead, weights):
    """The largest error of dense output in units of the tolerance, from the extrapolation error of the step before.

    Both errors are fourth differences, scaled by the products of the distances to the nodes. The embedded formula does
    not see it in components slaved to a stiff mode, which are accurate at the ends of steps of any length.
    """
    n = weights.size
    total = 0.0
    for k in range(n):
        part = (z[2 * n + k] - ahead[k]) * weights[k]
        total += part * part
    reach = (1.0 + ratio) * (1.0 - C1 + ratio) * (1.0 - C2 + ratio) / ratio**3
    return INSIDE / reach * math.sqrt(total / n)


@lean_inlined
def control(h, error, iterations, work, contracts):
    """Length of the next step (Gustafsson 1994); one nearly the same is kept, with its factorization."""
    safety = min(SAFETY, SAFETY * (1.0 + 2.0 * stages.ITERATIONS) / (iterations + 2.0 * stages.ITERATIONS))
    divisor = min(5.0, max(0.125, error**0.25 / safety))
    if error >= 1.0:
        work[layout.REJECTED] = 1.0
        work[layout.NEXT] = h / divisor
        return
    if work[layout.GOOD_LENGTH] > 0.0:
        trend = work[layout.GOOD_LENGTH] / h * (error * error / work[layout.GOOD_ERROR]) ** 0.25 / SAFETY
        divisor = max(divisor, min(5.0, max(0.125, trend)))
    wanted = h / divisor
    if work[layout.REJECTED] > 0.0:
        wanted = min(wanted, h)
    if work[layout.CEILING] > 0.0:
        wanted = min(wanted, max(h, work[layout.CEILING]))
        work[layout.CEILING] *= 1.2
    work[layout.NEXT] = h if work[layout.CONTRACTION] <= contracts and h <= wanted <= 1.2 * h else wanted


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h and its error; NaN and a shorter length where Newton's iteration fails."""
    jacobian = jacobian_at(functions[AT_JACOBIAN])
    n = y0.size
    at = layout.MEMORY
    z, before, w = work[at : at + 3 * n], work[at + 3 * n : at + 6 * n], work[at + 6 * n : at + 9 * n]
    f, start, weights = work[at + 9 * n : at + 12 * n], work[at + 12 * n : at + 13 * n], work[at + 13 * n : at + 14 * n]
    newton, ahead = work[at + 14 * n : at + 15 * n], work[at + 15 * n : at + 16 * n]
    at += layout.VECTORS * n
    values, store = work[at : at + numbers[layout.ROOM]], work[at + numbers[layout.ROOM] :]
    new = begin(t, y0, work, start, z, before)
    last = layout.HEAD + numbers[layout.TALLIES]
    plan, rows = numbers[last + numbers[layout.SCALED] :], settings[numbers[layout.ROWS_AT] :]
    small = False
    if numbers[layout.SCALED] > 0:
        later, moved, scales = f[:n], f[n : 2 * n], settings[layout.MEASURES :]
        foresee(functions, t, h, y0, rate0, scales, numbers[last:], later, moved, floats, ints)
        small = weigh(new, settings[layout.RELATIVE], h, y0, rate0, later, scales, numbers[last:], weights)
    else:
        for k in range(n):
            weights[k] = 1.0 / (settings[layout.MEASURES + k] + settings[layout.RELATIVE] * abs(y0[k]))
    work[layout.LENGTH] = h
    known = work[layout.BEFORE] > 0.0
    iterations, shorter = 0, 1.0
    while True:
        renewed = work[layout.FRESH] == 0.0 and (work[layout.CONTRACTION] > settings[layout.CONTRACTS] or shorter < 1.0)
        if renewed:
            jacobian(functions, t, y0, values, floats, ints)
            work[layout.FRESH] = 1.0
        if renewed or abs(h - work[layout.FACTORED]) > 1e-9 * h:
            regular = factor_at(numbers[layout.FACTOR])(plan, h, values, rows, store)
            work[layout.FACTORED] = h if regular else 0.0
        shorter = 0.5
        if work[layout.FACTORED] > 0.0:
            if small:
                scales = settings[layout.MEASURES :]
                shaken(functions, t, y0, rate0, scales, numbers[last:], f[:n], y1, floats, ints)
                if filter_at(numbers[layout.FILTER])(plan, work[layout.FACTORED], values, rows, store, f[:n]):
                    level(REAL, f[:n], scales, numbers[last:], weights)
                small = False
            for k in range(n):
                newton[k] = weights[k]
            for k in range(layout.HEAD, last):
                newton[numbers[k]] = 0.0
            guess_stages(n, h / work[layout.BEFORE] if known else 0.0, known, z, before, w, ahead)
            iterations, shorter = stages.iterate(
                functions, t, h, y0, y1, work, settings, numbers, floats, ints, values, plan, rows, store
            )
        if shorter == 0.0:
            break
        if work[layout.FRESH] > 0.0:
            work[layout.CONTRACTION] = 1.0
            work[layout.CONVERGENCE] = 1.0
            work[layout.REJECTED] = 1.0
            work[layout.CEILING] = 0.95 * h
            work[layout.NEXT] = shorter * h
            for k in range(n):
                y1[k] = math.nan
            return math.inf
    if tallies_move(numbers, n, z):
        finish_tallies(functions, t, h, y0, y1, numbers, floats, ints, z, f)
    error = 0.0
    if numbers[layout.FIXED] == 0:
        error = estimate(h, rate0, work, numbers, plan, rows, z, f, weights, values, store)
        if known:
            error = max(error, unevenness(h / work[layout.BEFORE], z, ahead, weights))
        error = max(1e-10, error)
        work[layout.ERROR] = error
        control(h, error, iterations, work, settings[layout.CONTRACTS])
    for k in range(n):
        y1[k] = y0[k] + z[2 * n + k]
    return error


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The collocation polynomial: third order (Hairer & Wanner 1996, eq. IV.8.14 and code RADAU5)."""
    n = y0.size
    s = theta - 1.0
    for k in range(n):
        z1, z2, z3 = work[layout.MEMORY + k], work[layout.MEMORY + n + k], work[layout.MEMORY + 2 * n + k]
        first = (z2 - z3) / (C2 - 1.0)
        inner = (z1 - z2) / (C1 - C2)
        second = (inner - first) / (C1 - 1.0)
        third = second - (inner - z1 / C1) / C2
        out[k] = y1[k] + s * (first + (s - C2 + 1.0) * (second + (s - C1 + 1.0) * third))
