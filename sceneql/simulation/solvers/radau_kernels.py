# mypy: ignore-errors
"""One step of the three-stage Radau IIA method, with its Newton iteration, error estimate and step control.

The stages z_i = Y_i - y0 solve z = h A F(z). With T diagonalizing the inverse of A, w = T^-1 z, a Newton iteration
needs one real and one complex system of the size of y: (g/h - J) and ((a + i b)/h - J). Source: Hairer & Wanner,
Solving Ordinary Differential Equations II (1996), IV.8; predictive control by Gustafsson (1994).

``settings`` = (relative tolerance, tolerance of Newton's iteration relative to that of the step, then the absolute
tolerance of each entry or the scales of scales_kernels.py). ``numbers`` = (1 if steps are fixed, length of ``values``,
entries m left in the linear systems, tallies, length of the plan of scales_kernels.py, which is 0 where absolute
tolerances are given; then m + m pivots, the tallies, that plan, the plan of reduced_kernels.py). ``work``: MEMORY
scalars, 18 vectors, the values, and three matrices m x m.
"""

import math

from numba import types

from sceneql.compiling.late import late
from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.pointers_kernels import AT_JACOBIAN, AT_RATE, jacobian_at, rate_at
from sceneql.simulation.solvers.reduced_kernels import factor_pair, factor_real, solve_pair, solve_real
from sceneql.simulation.solvers.scales_kernels import weigh
from sceneql.system_kernels import DENSE, STEP, A, F, I

MEMORY = 16
NEXT, START, LENGTH, BEFORE, GOOD_LENGTH, GOOD_ERROR, ERROR, CONVERGENCE, CONTRACTION, FACTORED = range(10)
"""Length to try next; start and length of the latest try; length of the step before it (0: unknown); length and error
of that step for the control; error of the try; Newton's convergence factor and rate; length that is factored."""
BEGUN, FRESH, REJECTED, CEILING = range(10, 14)
"""Whether there was a try; whether the Jacobian is that of the start; whether a try from here was rejected; length
beyond which Newton's iteration failed not long ago (0: none)."""

FIXED, ROOM, LEFT, TALLIES, SCALED, HEAD = range(6)

FINISH = types.void(I, F, F, A, A, I, A, I, A, A)
finish_tallies = late("sceneql.simulation.solvers.radau_tallies_kernels:finish_tallies", FINISH)

ITERATIONS = 7
ENOUGH = 0.03
"""Error of the stages, in units of the step's tolerance, that is good enough where the iteration stops."""
CONTRACTS = 1e-3
"""Newton's contraction rate below which the Jacobian serves one more step."""
SAFETY = 0.9

ROOT6 = math.sqrt(6.0)
C1, C2 = (4.0 - ROOT6) / 10.0, (4.0 + ROOT6) / 10.0
E1, E2, E3 = (-13.0 - 7.0 * ROOT6) / 3.0, (-13.0 + 7.0 * ROOT6) / 3.0, -1.0 / 3.0
REAL = 3.0 + 3.0 ** (2.0 / 3.0) - 3.0 ** (1.0 / 3.0)
ALPHA = 3.0 + 0.5 * (3.0 ** (1.0 / 3.0) - 3.0 ** (2.0 / 3.0))
BETA = 0.5 * (3.0 ** (5.0 / 6.0) + 3.0 ** (7.0 / 6.0))
"""Eigenvalues of the inverse of A: REAL, ALPHA +- i BETA."""

INSIDE = 0.01826
"""Largest |s (s - C1) (s - C2) (s - 1)| for s from 0 to 1."""

T11, T12, T13 = 0.09123239487089294279, -0.14125529502095420843, -0.03002919410514742449
T21, T22, T23 = 0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779
T31 = 0.96604818261509293619
"""T; its last row is (T31, 1, 0)."""
I11, I12, I13 = 4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119
I21, I22, I23 = -4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196
I31, I32, I33 = -0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497
"""Its inverse."""


@lean_inlined
def begin(t, y0, work, start, z, before):
    """Take note of what became of the try before: whether its stages can be extrapolated. True: y0 is a new start."""
    n = y0.size
    same = work[BEGUN] > 0.0 and t == work[START]
    follows = work[BEGUN] > 0.0 and not same
    for k in range(n):
        same = same and y0[k] == start[k]
        follows = follows and y0[k] == start[k] + z[2 * n + k]
    if same:
        return False
    work[REJECTED] = 0.0
    work[FRESH] = 0.0
    if follows:
        for k in range(3 * n):
            before[k] = z[k]
        work[BEFORE] = work[LENGTH]
        work[GOOD_LENGTH] = work[LENGTH]
        work[GOOD_ERROR] = max(0.01, work[ERROR])
    else:
        work[BEFORE] = 0.0
        work[GOOD_LENGTH] = 0.0
        work[CONTRACTION] = 1.0
        work[CONVERGENCE] = 1.0
    for k in range(n):
        start[k] = y0[k]
    work[BEGUN] = 1.0
    work[START] = t
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
        w[k] = I11 * a + I12 * b + I13 * c
        w[n + k] = I21 * a + I22 * b + I23 * c
        w[2 * n + k] = I31 * a + I32 * b + I33 * c


@lean_inlined
def evaluate_stages(rate, t, h, y0, y1, z, f, floats, ints):
    """f = the rate at the three stages; y1 is scratch."""
    n = y0.size
    for k in range(n):
        y1[k] = y0[k] + z[k]
    rate(t + C1 * h, y1, f[:n], floats, ints)
    for k in range(n):
        y1[k] = y0[k] + z[n + k]
    rate(t + C2 * h, y1, f[n : 2 * n], floats, ints)
    for k in range(n):
        y1[k] = y0[k] + z[2 * n + k]
    rate(t + h, y1, f[2 * n :], floats, ints)


@lean_inlined
def iterate(
    rate, t, h, y0, y1, work, settings, floats, ints, z, w, f, weights,
    values, plan, pivots, real, re, im, spare, other,
):  # fmt: skip
    """Newton's iteration on the stages: (iterations, factor for h to try after a failure; 0: it has converged)."""
    n = y0.size
    m = pivots.size // 2
    g, a, b = REAL / h, ALPHA / h, BETA / h
    tolerance = settings[1]
    enough = max(tolerance, ENOUGH)
    convergence = max(work[CONVERGENCE], 2.2e-16) ** 0.8
    size = before = rate_before = 0.0
    work[CONTRACTION] = CONTRACTS
    for count in range(1, ITERATIONS + 1):
        evaluate_stages(rate, t, h, y0, y1, z, f, floats, ints)
        for k in range(n):
            f1, f2, f3 = f[k], f[n + k], f[2 * n + k]
            w2, w3 = w[n + k], w[2 * n + k]
            f[k] = I11 * f1 + I12 * f2 + I13 * f3 - g * w[k]
            f[n + k] = I21 * f1 + I22 * f2 + I23 * f3 - a * w2 + b * w3
            f[2 * n + k] = I31 * f1 + I32 * f2 + I33 * f3 - a * w3 - b * w2
        solve_real(REAL / work[FACTORED], values, plan, real, pivots[:m], spare, f[:n])
        solve_pair(
            ALPHA / work[FACTORED],
            BETA / work[FACTORED],
            values,
            plan,
            re,
            im,
            pivots[m:],
            spare,
            other,
            f[n : 2 * n],
            f[2 * n :],
        )
        total = 0.0
        for k in range(n):
            d1, d2, d3 = f[k], f[n + k], f[2 * n + k]
            total += (d1 * d1 + d2 * d2 + d3 * d3) * (weights[k] * weights[k])
            w1, w2, w3 = w[k] + d1, w[n + k] + d2, w[2 * n + k] + d3
            w[k], w[n + k], w[2 * n + k] = w1, w2, w3
            z[k] = T11 * w1 + T12 * w2 + T13 * w3
            z[n + k] = T21 * w1 + T22 * w2 + T23 * w3
            z[2 * n + k] = T31 * w1 + w2
        size = math.sqrt(total / (3 * n))
        if not size < math.inf:
            return count, 0.5
        if count > 1:
            now = size / before
            contraction = now if count == 2 else math.sqrt(now * rate_before)
            rate_before = now
            if count == 2 and contraction >= 0.99 and size > enough:
                # Stiff springs that turn: every other change is large, so two together tell.
                before = size
                continue
            if contraction >= 0.99:
                # Rounding keeps very stiff systems from getting closer.
                return (count, 0.0) if size <= enough else (count, 0.5)
            work[CONTRACTION] = contraction
            convergence = contraction / (1.0 - contraction)
            left = ITERATIONS - count
            ahead = convergence * size * contraction**left / enough
            if ahead >= 1.0:
                return count, 0.8 * min(20.0, max(1e-4, ahead)) ** (-1.0 / (4.0 + left))
        if convergence * size <= tolerance:
            work[CONVERGENCE] = convergence
            return count, 0.0
        before = max(size, 2.2e-16)
    return ITERATIONS, 0.0 if convergence * size <= enough else 0.5


@lean_inlined
def tallies_move(numbers, n, z):
    """Whether any sum that nothing depends on changes in the step."""
    first = HEAD + 2 * numbers[LEFT]
    for k in range(first, first + numbers[TALLIES]):
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
def estimate(rate, t, h, y0, rate0, y1, work, floats, ints, z, f, weights, values, plan, pivots, real, spare):
    """The error in units of the tolerance, by the embedded third-order formula, filtered by (REAL/h - J)^-1."""
    n = y0.size
    error, embedded = f[:n], f[n : 2 * n]
    for k in range(n):
        embedded[k] = (E1 * z[k] + E2 * z[n + k] + E3 * z[2 * n + k]) / h
        error[k] = rate0[k] + embedded[k]
    solve_real(REAL / work[FACTORED], values, plan, real, pivots, spare, error)
    return norm(error, weights)


@lean_inlined
def unevenness(ratio, z, ahead, weights):
    """The largest error of dense output in units of the tolerance, by how far the polynomial before missed this step.

    Both are fourth differences, scaled by the products of the distances to the nodes. The embedded formula does not
    see it in components that a stiff mode pulls along: they are right at the ends of steps of any length.
    """
    n = weights.size
    total = 0.0
    for k in range(n):
        part = (z[2 * n + k] - ahead[k]) * weights[k]
        total += part * part
    reach = (1.0 + ratio) * (1.0 - C1 + ratio) * (1.0 - C2 + ratio) / ratio**3
    return INSIDE / reach * math.sqrt(total / n)


@lean_inlined
def control(h, error, iterations, work):
    """Length of the next step (Gustafsson 1994); nearly the same one is kept, with its factors."""
    safety = min(SAFETY, SAFETY * (1.0 + 2.0 * ITERATIONS) / (iterations + 2.0 * ITERATIONS))
    divisor = min(5.0, max(0.125, error**0.25 / safety))
    if error >= 1.0:
        work[REJECTED] = 1.0
        work[NEXT] = h / divisor
        return
    if work[GOOD_LENGTH] > 0.0:
        trend = work[GOOD_LENGTH] / h * (error * error / work[GOOD_ERROR]) ** 0.25 / SAFETY
        divisor = max(divisor, min(5.0, max(0.125, trend)))
    wanted = h / divisor
    if work[REJECTED] > 0.0:
        wanted = min(wanted, h)
    if work[CEILING] > 0.0:
        wanted = min(wanted, max(h, work[CEILING]))
        work[CEILING] *= 1.2
    work[NEXT] = h if work[CONTRACTION] <= CONTRACTS and h <= wanted <= 1.2 * h else wanted


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h and its error; NaN and a shorter length where Newton's iteration fails."""
    rate, jacobian = rate_at(functions[AT_RATE]), jacobian_at(functions[AT_JACOBIAN])
    n, m = y0.size, numbers[LEFT]
    at = MEMORY
    z, before, w = work[at : at + 3 * n], work[at + 3 * n : at + 6 * n], work[at + 6 * n : at + 9 * n]
    f, start, weights = work[at + 9 * n : at + 12 * n], work[at + 12 * n : at + 13 * n], work[at + 13 * n : at + 14 * n]
    newton = work[at + 14 * n : at + 15 * n]
    spare, other = work[at + 15 * n : at + 15 * n + m], work[at + 16 * n : at + 16 * n + m]
    ahead = work[at + 17 * n : at + 18 * n]
    at += 18 * n
    values = work[at : at + numbers[ROOM]]
    at += numbers[ROOM]
    real, re, im = work[at : at + m * m], work[at + m * m : at + 2 * m * m], work[at + 2 * m * m : at + 3 * m * m]
    new = begin(t, y0, work, start, z, before)
    pivots = numbers[HEAD : HEAD + 2 * m]
    first = HEAD + 2 * m
    last = first + numbers[TALLIES]
    plan = numbers[last + numbers[SCALED] :]
    if numbers[SCALED] > 0:
        weigh(new, settings[0], h, y0, rate0, settings[2:], numbers[last:], weights)
    else:
        for k in range(n):
            weights[k] = 1.0 / (settings[2 + k] + settings[0] * abs(y0[k]))
    for k in range(n):
        newton[k] = weights[k]
    for k in range(first, last):
        newton[numbers[k]] = 0.0
    work[LENGTH] = h
    known = work[BEFORE] > 0.0
    iterations, shorter = 0, 1.0
    while True:
        renewed = work[FRESH] == 0.0 and (work[CONTRACTION] > CONTRACTS or shorter < 1.0)
        if renewed:
            jacobian(functions, t, y0, values, floats, ints)
            work[FRESH] = 1.0
        if renewed or abs(h - work[FACTORED]) > 1e-9 * h:
            regular = factor_real(REAL / h, values, plan, real, pivots[:m])
            regular = regular and factor_pair(ALPHA / h, BETA / h, values, plan, re, im, pivots[m:])
            work[FACTORED] = h if regular else 0.0
        shorter = 0.5
        if work[FACTORED] > 0.0:
            guess_stages(n, h / work[BEFORE] if known else 0.0, known, z, before, w, ahead)
            iterations, shorter = iterate(
                rate, t, h, y0, y1, work, settings, floats, ints, z, w, f, newton,
                values, plan, pivots, real, re, im, spare, other,
            )  # fmt: skip
        if shorter == 0.0:
            break
        if work[FRESH] > 0.0:
            work[CONTRACTION] = 1.0
            work[CONVERGENCE] = 1.0
            work[REJECTED] = 1.0
            work[CEILING] = 0.95 * h
            work[NEXT] = shorter * h
            for k in range(n):
                y1[k] = math.nan
            return math.inf
    if tallies_move(numbers, n, z):
        finish_tallies(functions, t, h, y0, y1, numbers, floats, ints, z, f)
    error = 0.0
    if numbers[FIXED] == 0:
        error = estimate(
            rate, t, h, y0, rate0, y1, work, floats, ints, z, f, weights, values, plan, pivots[:m], real, spare
        )
        if known:
            error = max(error, unevenness(h / work[BEFORE], z, ahead, weights))
        error = max(1e-10, error)
        work[ERROR] = error
        control(h, error, iterations, work)
    for k in range(n):
        y1[k] = y0[k] + z[2 * n + k]
    return error


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The collocation polynomial: third order (Hairer & Wanner 1996, eq. IV.8.14 and code RADAU5)."""
    n = y0.size
    s = theta - 1.0
    for k in range(n):
        z1, z2, z3 = work[MEMORY + k], work[MEMORY + n + k], work[MEMORY + 2 * n + k]
        first = (z2 - z3) / (C2 - 1.0)
        inner = (z1 - z2) / (C1 - C2)
        second = (inner - first) / (C1 - 1.0)
        third = second - (inner - z1 / C1) / C2
        out[k] = y1[k] + s * (first + (s - C2 + 1.0) * (second + (s - C1 + 1.0) * third))
