# mypy: ignore-errors
"""One step of Everhart's method of order 15 (gauss_radau.py has its numbers).

``numbers`` = (1 if the error is wanted, entries m that rates push, positions p, groups, indices of the m, of which the
first p are the velocities of the positions, indices of the p, ends of the groups among the m). A group's entries share
a time scale; what follows the last group sets no step. ``settings`` = (tolerance, gauss_radau.settings()). ``work``:
eight scalars, then vectors of y's size; each of the polynomial's coefficients is a vector of m entries.

The method keeps the previous step's polynomial and the rounding error of y (compensated summation) for the next one; a
step that does not start at the previous one's end starts without them.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.compiled.vectors_kernels import same
from sceneql.system.signatures_kernels import DENSE, STEP

CONTROLLED, PUSHED, POSITIONS, GROUPS, ENTRIES = range(5)
TOLERANCE = 0
NEXT, BEGAN, TRIED, BEFORE = range(4)
"""Scalars of work: length of the next step; start and length of the last try; length of the step before it [s]."""
HEAD = 8

B, GUESS, LAST, LAST_GUESS, NEWTON = 0, 7, 14, 21, 28
"""Vectors of work: the polynomial of the last try and its prediction, both of the step before; Newton form of the first
polynomial, which the passes over the nodes compute."""
SLOPE, SEEN, START, END, LOW, LOW_END, VECTORS = 35, 36, 37, 38, 39, 40, 41
"""Rate and state at a node; ends of the last try and the rounding error of each."""

DEGREE = 7
FOR_VELOCITIES = 1 + 8
FOR_POSITIONS = FOR_VELOCITIES + 8 * DEGREE
DIFFERENCES = FOR_POSITIONS + 8 * DEGREE
TO_POWERS = DIFFERENCES + DEGREE * DEGREE
TO_NEWTON = TO_POWERS + DEGREE * DEGREE
BINOMIALS = TO_NEWTON + DEGREE * DEGREE

MOST_SWEEPS = 12
"""A step whose iteration takes more is taken again, shorter."""
CONVERGED = 1e-14
"""Change of the last coefficient, relative to the rate, expected of the next pass by the last two: an eighth of it
enters the velocity's change in the step, below its rounding error."""
LONGEST_RATIO = 20.0
"""Largest ratio of a step to the one before for which the prediction helps."""
NEGLIGIBLE = 1e-12
"""Rate of a group against the largest of all, below which it may be rounding; and how far a step moves it, against the
largest of the numbers that are moved so."""
SHRINKAGE = 0.25
"""A step is taken again when the next would be shorter than this times it (Rein & Spiegel 2015, section 2.3)."""


@lean_inlined
def remember(t, y0, work, vectors, settled):
    """Keep the last try as the previous step if it ended at (t, y0); clear the memory at any other new start."""
    n = y0.size
    if t > work[BEGAN] and (settled or same(y0, vectors[END * n : (END + 1) * n])):
        for k in range(14 * n):
            vectors[LAST * n + k] = vectors[B * n + k]
        for k in range(n):
            vectors[LOW * n + k] = vectors[LOW_END * n + k]
        work[BEFORE] = work[TRIED]
    elif t != work[BEGAN] or not same(y0, vectors[START * n : (START + 1) * n]):
        for k in range(n):
            vectors[LOW * n + k] = 0.0
        work[BEFORE] = 0.0
    for k in range(n):
        vectors[START * n + k] = y0[k]
    work[BEGAN] = t


@lean_inlined
def predict(ratio, n, m, vectors, settings):
    """The polynomial of the step before, extrapolated, plus the error of the last prediction."""
    power = 1.0
    for i in range(DEGREE):
        power *= ratio
        guess = vectors[(GUESS + i) * n :]
        for j in range(m):
            guess[j] = 0.0
        for k in range(i, DEGREE):
            weight = power * settings[BINOMIALS + i * DEGREE + k]
            for j in range(m):
                guess[j] += weight * vectors[(LAST + k) * n + j]
        for j in range(m):
            correction = vectors[(LAST + i) * n + j] - vectors[(LAST_GUESS + i) * n + j]
            vectors[(B + i) * n + j] = guess[j] + correction


@lean_inlined
def convert(matrix, source, target, n, m, vectors, settings):
    """Convert between the polynomial's powers and its Newton form."""
    for i in range(DEGREE):
        for j in range(m):
            total = vectors[(source + i) * n + j]
            for k in range(i + 1, DEGREE):
                total += settings[matrix + k * DEGREE + i] * vectors[(source + k) * n + j]
            vectors[(target + i) * n + j] = total


@lean_inlined
def inside(end, h, y0, rate0, vectors, settings, numbers, out, m, p):
    """out = the state at one of the eight ends of integration; LOW_END = its rounding error (Kahan 1965)."""
    n = y0.size
    s = h * settings[1 + end]
    newton, low, left = vectors[NEWTON * n :], vectors[LOW * n :], vectors[LOW_END * n :]
    once, twice = settings[FOR_VELOCITIES + end * DEGREE :], settings[FOR_POSITIONS + end * DEGREE :]
    for j in range(m):
        k = numbers[ENTRIES + j]
        g0, g1, g2, g3 = newton[j], newton[n + j], newton[2 * n + j], newton[3 * n + j]
        g4, g5, g6 = newton[4 * n + j], newton[5 * n + j], newton[6 * n + j]
        change = (once[6] * g6 + once[5] * g5) + (once[4] * g4 + once[3] * g3) + (once[2] * g2 + once[1] * g1)
        total = s * ((change + once[0] * g0) + rate0[k]) - low[k]
        out[k] = y0[k] + total
        left[k] = (out[k] - y0[k]) - total
        if j < p:
            at = numbers[ENTRIES + m + j]
            change = (twice[6] * g6 + twice[5] * g5) + (twice[4] * g4 + twice[3] * g3) + (twice[2] * g2 + twice[1] * g1)
            change = s * ((change + twice[0] * g0) + 0.5 * rate0[k])
            total = s * (change + (y0[k] - low[k])) - low[at]
            out[at] = y0[at] + total
            left[at] = (out[at] - y0[at]) - total


@lean_inlined
def correct(i, m, watched, rate0, vectors, settings, numbers, n):
    """Put the rate at node i into the Newton form; the largest change of its coefficient over the watched entries."""
    slope, newton = vectors[SLOPE * n :], vectors[NEWTON * n :]
    inverse = settings[DIFFERENCES + i * DEGREE :]
    most = 0.0
    for j in range(m):
        k = numbers[ENTRIES + j]
        value = (slope[k] - rate0[k]) * inverse[0]
        for before in range(i):
            value = (value - newton[before * n + j]) * inverse[before + 1]
        change = abs(value - newton[i * n + j])
        newton[i * n + j] = value
        if j < watched:
            most = max(most, change)
    return most


@lean_inlined
def shortest_square(n, m, p, groups, h, y0, rate0, vectors, numbers):
    """The square of the shortest time, in steps, in which a group's rate changes by its own size; 1e300: it does not.

    The criterion of Pham, Rein & Spiegel (2024) at the step's end, in the mean of the squares for the rate and for its
    first derivative: so an oscillation has the same time in all its phases, where the rate alone would have none as it
    passes through zero. A group that hardly moves, against the others or at all, is left out: what is at rest has rates
    that are rounding.
    """
    b = vectors[B * n :]
    largest = far = loose = 0.0
    for j in range(numbers[ENTRIES - 1 + m + p + groups]):
        largest = max(largest, abs(rate0[numbers[ENTRIES + j]]))
        if j >= p > 0:  # of bodies
            loose = max(loose, abs(y0[numbers[ENTRIES + j]]))
    for j in range(p):
        far = max(far, abs(y0[numbers[ENTRIES + m + j]]))
    best = 1e300
    j = 0
    for group in range(groups):
        moved, least = (h * h, far) if j < p else (h, loose)
        zeroth = first = second = third = 0.0
        while j < numbers[ENTRIES + m + p + group]:
            f0 = rate0[numbers[ENTRIES + j]]
            f1 = f2 = f3 = 0.0
            for i in range(DEGREE):
                term, power = b[i * n + j], i + 1.0
                f0 += term
                f1 += power * term
                f2 += power * (power - 1.0) * term
                f3 += power * (power - 1.0) * (power - 2.0) * term
            zeroth += f0 * f0
            first += f1 * f1
            second += f2 * f2
            third += f3 * f3
            j += 1
        if max(zeroth, first) > (NEGLIGIBLE * max(largest, least / moved)) ** 2:
            square = 2.0 * zeroth / (first + math.sqrt(zeroth * second)) if first + second > 0.0 else 1e300
            if second > 0.0:
                square = 0.5 * square + first / (second + math.sqrt(first * third))
            best = min(best, square)
    return best


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the error is a quarter of it against the length that fits."""
    rate = rate_at(functions[AT_RATE])
    n = y0.size
    m, p, groups = numbers[PUSHED], numbers[POSITIONS], numbers[GROUPS]
    watched = numbers[ENTRIES - 1 + m + p + groups]
    vectors = work[HEAD:]
    remember(t, y0, work, vectors, floats[channels.SETTLED] != 0.0)
    work[TRIED] = h
    if work[BEFORE] > 0.0 and h < LONGEST_RATIO * work[BEFORE]:
        predict(h / work[BEFORE], n, m, vectors, settings)
    else:
        for k in range(14 * n):
            vectors[B * n + k] = 0.0
    convert(TO_NEWTON, B, NEWTON, n, m, vectors, settings)
    slope, seen = vectors[SLOPE * n : (SLOPE + 1) * n], vectors[SEEN * n : (SEEN + 1) * n]
    size = 0.0
    previous = 2.0
    settled = False
    for sweep in range(MOST_SWEEPS):
        change = 0.0
        for i in range(DEGREE):
            inside(i, h, y0, rate0, vectors, settings, numbers, seen, m, p)
            rate(t + settings[1 + i] * h, seen, slope, floats, ints)
            change = correct(i, m, watched, rate0, vectors, settings, numbers, n)
        size = 0.0
        for j in range(watched):
            k = numbers[ENTRIES + j]
            size = max(size, max(abs(slope[k]), abs(rate0[k])))
        change = change / size if size > 0.0 else 0.0
        if sweep > 0 and (change * change < CONVERGED * previous or (sweep > 1 and change >= previous)):
            settled = True
            break
        previous = change
    inside(DEGREE, h, y0, rate0, vectors, settings, numbers, y1, m, p)
    convert(TO_POWERS, NEWTON, B, n, m, vectors, settings)
    for k in range(n):
        vectors[END * n + k] = y1[k]
    if numbers[CONTROLLED] == 0:
        return 0.0
    if not settled and math.isfinite(previous):  # as a first step may, which has no prediction
        work[NEXT] = SHRINKAGE * h
        return 2.0
    square = shortest_square(n, m, p, groups, h, y0, rate0, vectors, numbers)
    longest = h / SHRINKAGE
    work[NEXT] = min(longest, h * math.sqrt(square) * (5040.0 * settings[TOLERANCE]) ** (1.0 / 7.0))
    return SHRINKAGE * h / work[NEXT]


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The polynomial's own integrals, up to theta."""
    n = y0.size
    m, p = numbers[PUSHED], numbers[POSITIONS]
    s = h * theta
    b = work[HEAD + B * n :]
    for j in range(m):
        k = numbers[ENTRIES + j]
        once = 0.0
        for i in range(DEGREE, 0, -1):
            once = theta * (once + b[(i - 1) * n + j] / (i + 1))
        out[k] = y0[k] + s * (rate0[k] + once)
    for j in range(p):
        k, at = numbers[ENTRIES + j], numbers[ENTRIES + m + j]
        twice = 0.0
        for i in range(DEGREE, 0, -1):
            twice = theta * (twice + b[(i - 1) * n + j] / ((i + 1) * (i + 2)))
        out[at] = y0[at] + s * (y0[k] + s * (0.5 * rate0[k] + twice))
