# mypy: ignore-errors
"""One step of Adams' formulas of any order on steps of any length (Krogh 1974; Shampine & Gordon 1975).

The rate in a step of length h is taken to be the polynomial through k rates before it, at nodes that lie gaps_i behind
its start, and through the rate at the end that its first k terms predict:

    sum over j <= k of phi*_j prod_{i<j} (s + gaps_i)/(h + gaps_i),    0 <= s <= h,

with modified divided differences: phi*_j = betas_j phi_j for j < k, and phi_k = rate predicted - sum of all those. The
integrals of the products are the weights of the step, and up to any s those of its dense output. The rate at the end is
left to the march; it enters the differences when the next step begins, phi_j becoming phi_{j-1} - phi*_{j-1}.

``numbers`` = (1 if steps follow the error, the highest k). ``settings`` = (relative tolerance, absolute tolerance).
``work``: scalars (NEXT to COLUMN), then vectors (PHI to LOW_END), of y's size and zeros up to a whole number of LANES.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import load, spread, store
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.compiled.vectors_kernels import same
from sceneql.system.signatures_kernels import DENSE, STEP, A, F, I, N

MOST = 12
"""Largest number k of rates before a step; its order is one more, and the error is that of order k."""
CONTROLLED, HIGHEST = range(2)
RELATIVE, ABSOLUTE = range(2)

NEXT, BEGAN, TRIED, USED, WANTED, KNOWN, RISES, FAILED = range(8)
"""Scalars of work: length of the step to try next; start and length of the latest try [s]; its number of rates, and
that of the next step; number of differences, the rate at the start left out, that are known; whether every step raises
the order, as at a new start; failed tries of this step."""
GAPS, BETAS, WEIGHTS, COLUMN, HEAD = range(8, 8 + 5 * (MOST + 2), MOST + 2)
PHI, LAST, START, END, SLOPE, LOW, LOW_END, VECTORS = 0, *range(MOST + 2, MOST + 9)
"""Vectors of work: the differences at the step's start; phi_k; the step's ends; the rate at the predicted end; rounding
errors of the ends (compensated summation, Kahan 1965)."""

LANES = 8

AIM = 0.3
"""Error of the next step that its length is chosen for."""
GROWTH, MOST_GROWTH = 1.05, 2.0
"""Factor below which steps do not grow, as changes of length cost accuracy; largest factor."""
LOW_ORDER_AT = 3
"""Failed tries of a step after which it begins anew with order 2: the rate has jumped."""


@lean(types.void(F, F, N, A), inner=True)
def integrate(theta, h, k, work):
    """Write the integrals of the products 0 to k from 0 to theta h, over h, to the weights.

    By repeated integrals, as Hairer, Norsett & Wanner (1993, III.5, eq. 5.9), there for theta = 1.
    """
    column = work[COLUMN:]
    power = 1.0
    for q in range(k + 1):
        power *= theta
        column[q] = power / (q + 1.0)
    work[WEIGHTS] = column[0]
    for j in range(k):
        part = h / (h + work[GAPS + j])
        rest = 1.0 - part + part * theta
        for q in range(k - j):
            column[q] = rest * column[q] - part * column[q + 1]
        work[WEIGHTS + j + 1] = column[0]


@lean_inlined
def room_of(n):
    """Numbers of a vector of work, for n entries of y."""
    return LANES * ((n + LANES - 1) // LANES)


@lean_inlined
def enter(rate0, work, vectors):
    """Enter the rate at the end of the latest step into the differences, and its length into the gaps."""
    n = room_of(rate0.size)
    carried = vectors[SLOPE * n :]
    for i in range(rate0.size):
        carried[i] = rate0[i]
    known = min(int(work[KNOWN]), int(work[USED])) + 1
    betas = work[BETAS:]
    for i in range(0, n, LANES):
        rest = load(carried, i)
        for j in range(known):
            at = (PHI + j) * n + i
            old = betas[j] * load(vectors, at)
            store(vectors, at, rest)
            rest = rest - old
        store(vectors, (PHI + known) * n + i, rest)
        store(vectors, LOW * n + i, load(vectors, LOW_END * n + i))
    for j in range(MOST + 1, 0, -1):
        work[GAPS + j] = work[GAPS + j - 1] + work[TRIED]
    work[KNOWN] = known
    work[FAILED] = 0.0


@lean_inlined
def begin(t, y0, rate0, work, vectors, settled):
    """Whether this try goes on from the latest step, repeats it or begins anew; returns the number of rates to use."""
    n = room_of(y0.size)
    start, end = vectors[START * n : START * n + y0.size], vectors[END * n : END * n + y0.size]
    if work[USED] > 0.0 and t == work[BEGAN] + work[TRIED] and (settled or same(y0, end)):
        enter(rate0, work, vectors)
    elif not (work[USED] > 0.0 and t == work[BEGAN] and same(y0, start)):
        work[KNOWN] = work[FAILED] = work[GAPS] = 0.0
        work[RISES] = work[WANTED] = 1.0
        for i in range(y0.size):
            vectors[PHI * n + i] = rate0[i]
            vectors[LOW * n + i] = 0.0
    for i in range(y0.size):
        start[i] = y0[i]
    work[BEGAN] = t
    work[USED] = min(work[WANTED], work[KNOWN] + 1.0)
    return int(work[USED])


@lean_inlined
def begin_low(h, error, work):
    """After tries that failed at the lowest order, the step of the error aimed at."""
    factor = math.sqrt(AIM / error) if math.isfinite(error) else 0.1
    work[NEXT] = h * min(0.5, max(1e-6, factor))


@lean(types.void(F, N, F, F, F, F, A, I), inner=True)
def choose(h, k, error, below, far_below, above, work, numbers):
    """Choose order and length of the next step by the errors of k, k - 1, k - 2 and k + 1 rates.

    A lower order is taken when its error is not larger, and when errors fall with falling order; a higher one when its
    error is smaller and the errors fall towards it (Shampine & Gordon 1975, chapter 7).
    """
    wanted = k
    if (k > 2 and max(below, far_below) <= error) or (k == 2 and below <= 0.5 * error):
        wanted = k - 1
    if numbers[CONTROLLED] != 0 and not error <= 1.0:
        work[RISES] = 0.0
        work[FAILED] += 1.0
        work[WANTED] = 1.0 if work[FAILED] >= LOW_ORDER_AT else wanted
        work[NEXT] = 0.5 * h
        if k == 1:
            begin_low(h, error, work)
        return
    if wanted < k or k >= numbers[HIGHEST]:
        work[RISES] = 0.0
    if work[RISES] != 0.0:
        work[WANTED], work[NEXT] = k + 1.0, MOST_GROWTH * h
        return
    if wanted == k:
        may_rise = above < math.inf and k < numbers[HIGHEST]
        if k > 1 and below <= min(error, above):
            wanted = k - 1
        elif may_rise and above < (0.5 * error if k == 1 else error):
            wanted = k + 1
    expected = below if wanted < k else (above if wanted > k else error)
    factor = (AIM / max(expected, 1e-100)) ** (1.0 / (wanted + 1.0))
    if factor >= 1.0:
        factor = min(factor, MOST_GROWTH) if factor >= GROWTH else 1.0
    else:
        factor = max(0.5, min(0.9, factor))
    work[WANTED], work[NEXT] = wanted, factor * h


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the error of the order below in the root mean square of all entries."""
    count, n = y0.size, room_of(y0.size)
    rate = rate_at(functions[AT_RATE])
    vectors = work[HEAD:]
    k = begin(t, y0, rate0, work, vectors, floats[channels.SETTLED] != 0.0)
    work[TRIED] = h
    all_known = work[KNOWN] >= k
    beta = work[BETAS] = 1.0
    for j in range(1, k + all_known):
        beta *= (h + work[GAPS + j - 1]) / work[GAPS + j]
        work[BETAS + j] = beta
    integrate(1.0, h, k + 1, work)
    weights, betas = work[WEIGHTS:], work[BETAS:]
    slope, last = vectors[SLOPE * n : SLOPE * n + count], vectors[LAST * n : LAST * n + count]
    end = vectors[END * n : END * n + count]
    for i in range(0, n, LANES):
        ends = lasts = spread(0.0)
        for j in range(k - 1, -1, -1):
            part = betas[j] * load(vectors, (PHI + j) * n + i)
            ends, lasts = ends + weights[j] * part, lasts + part
        store(vectors, END * n + i, ends)
        store(vectors, LAST * n + i, lasts)
    for i in range(count):
        y1[i] = y0[i] + h * end[i]
    rate(t + h, y1, slope, floats, ints)
    second, third = max(k - 2, 0), vectors[(PHI + k) * n :]
    first, second_phi = vectors[(PHI + k - 1) * n :], vectors[(PHI + second) * n :]
    beta_first, beta_second = betas[k - 1], betas[second]
    beta_third = betas[k] if all_known else 0.0
    low, low_end = vectors[LOW * n :], vectors[LOW_END * n :]
    weight, absolute, relative = weights[k], settings[ABSOLUTE], settings[RELATIVE]
    error = below = far_below = above = 0.0
    for i in range(count):
        phi = slope[i] - last[i]
        last[i] = phi
        change = h * (end[i] + weight * phi) - low[i]
        y1[i] = y0[i] + change
        low_end[i] = (y1[i] - y0[i]) - change
        end[i] = y1[i]
        scale = 1.0 / (absolute + relative * max(abs(y0[i]), abs(y1[i])))
        lower = phi + beta_first * first[i]
        lowest = lower + beta_second * second_phi[i]
        higher = phi - beta_third * third[i]
        error += (phi * scale) ** 2
        below += (lower * scale) ** 2
        far_below += (lowest * scale) ** 2
        above += (higher * scale) ** 2
    error = h * abs(weights[k - 1] - weight) * math.sqrt(error / count)
    below = h * abs(weights[max(k - 2, 0)] - weights[k - 1]) * math.sqrt(below / count)
    far_below = h * abs(weights[max(k - 3, 0)] - weights[second]) * math.sqrt(far_below / count)
    above = h * abs(weight - weights[k + 1]) * math.sqrt(above / count) if all_known else math.inf
    choose(h, k, error, below, far_below, above, work, numbers)
    return error if numbers[CONTROLLED] != 0 else 0.0


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The integral of the step's own polynomial: of the step's order, and its very ends."""
    n = room_of(y0.size)
    k = int(work[USED])
    integrate(theta, h, k, work)
    vectors = work[HEAD:]
    for i in range(y0.size):
        out[i] = work[WEIGHTS + k] * vectors[LAST * n + i]
    for j in range(k):
        weight = work[WEIGHTS + j] * work[BETAS + j]
        for i in range(y0.size):
            out[i] += weight * vectors[(PHI + j) * n + i]
    for i in range(y0.size):
        out[i] = y0[i] + h * out[i]
