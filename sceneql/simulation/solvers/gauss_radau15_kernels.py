# mypy: ignore-errors
"""One step of Everhart's method of order 15 (gauss_radau.py has its numbers).

``numbers`` = (1 if the error is wanted, entries m that rates push, how many of them the error looks at, positions p,
indices of the m, indices of the p, for each position the place of its velocity among the m). ``settings`` = (tolerance,
gauss_radau.settings()). ``work``: eight scalars, then vectors of y's size, where the polynomial's seven coefficients
are the m entries one after the other.

The method remembers the step before (its polynomial, and what rounding left out of y), by which a new one starts; a
start that is not its end has no memory.
"""

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.pointers_kernels import AT_RATE, rate_at
from sceneql.system_kernels import DENSE, STEP

NEXT, BEGAN, TRIED, BEFORE = range(4)
"""Scalars of work: length of the next step; start and length of the last try; length of the step before it [s]."""
HEAD = 8

B, GUESS, LAST, LAST_GUESS, NEWTON = 0, 7, 14, 21, 28
"""Vectors of work: the polynomial of the last try, what was predicted for it, both of the step before; Newton form."""
SLOPE, SEEN, START, END, LOW, LOW_END, VECTORS = 35, 36, 37, 38, 39, 40, 41
"""Rate and state at a node; ends of the last try and what rounding left out of each."""

DEGREE = 7
FOR_VELOCITIES = 1 + 8
FOR_POSITIONS = FOR_VELOCITIES + 8 * DEGREE
DIFFERENCES = FOR_POSITIONS + 8 * DEGREE
TO_POWERS = DIFFERENCES + DEGREE * DEGREE
TO_NEWTON = TO_POWERS + DEGREE * DEGREE
BINOMIALS = TO_NEWTON + DEGREE * DEGREE

MOST_SWEEPS = 12
CONVERGED = 1e-16
LONGEST_RATIO = 20.0
"""Of a step to the one before, for a prediction that helps."""
SHRINKAGE = 0.25
"""A step is taken again when the next would be shorter than this times it (Rein & Spiegel 2015, section 2.3)."""


@lean_inlined
def same(a, b):
    """Whether two vectors are equal."""
    for k in range(a.size):
        if a[k] != b[k]:
            return False
    return True


@lean_inlined
def remember(t, y0, work, vectors):
    """Make the memory that of the step that ended at (t, y0), and put down this start."""
    n = y0.size
    if t > work[BEGAN] and same(y0, vectors[END * n : (END + 1) * n]):
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
    """The polynomial of the step before, continued, plus what was wrong with the last prediction."""
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
def polynomial(weights, j, n, vectors, settings):
    """Sum of weights times the coefficients of entry j, small ones first."""
    total = 0.0
    for back in range(DEGREE):
        i = DEGREE - 1 - back
        total += settings[weights + i] * vectors[(B + i) * n + j]
    return total


@lean_inlined
def inside(end, h, y0, rate0, vectors, settings, numbers, out, m, p):
    """out = the state at one of the eight ends of integration; LOW_END = what rounding left out (Kahan 1965)."""
    n = y0.size
    s = h * settings[1 + end]
    low, left = vectors[LOW * n :], vectors[LOW_END * n :]
    for j in range(m):
        k = numbers[4 + j]
        change = polynomial(FOR_VELOCITIES + end * DEGREE, j, n, vectors, settings) + rate0[k]
        total = s * change - low[k]
        out[k] = y0[k] + total
        left[k] = (out[k] - y0[k]) - total
    for q in range(p):
        at, j = numbers[4 + m + q], numbers[4 + m + p + q]
        k = numbers[4 + j]
        change = polynomial(FOR_POSITIONS + end * DEGREE, j, n, vectors, settings) + 0.5 * rate0[k]
        total = s * (s * change + (y0[k] - low[k])) - low[at]
        out[at] = y0[at] + total
        left[at] = (out[at] - y0[at]) - total


@lean_inlined
def correct(i, m, rate0, vectors, settings, numbers, n):
    """Put the rate at node i into the polynomial; the largest change of its last coefficient where it is looked at."""
    slope = vectors[SLOPE * n :]
    row = i * DEGREE
    most = 0.0
    for j in range(m):
        k = numbers[4 + j]
        value = (slope[k] - rate0[k]) * settings[DIFFERENCES + row]
        for before in range(1, i + 1):
            value = (value - vectors[(NEWTON + before - 1) * n + j]) * settings[DIFFERENCES + row + before]
        change = value - vectors[(NEWTON + i) * n + j]
        vectors[(NEWTON + i) * n + j] = value
        for power in range(i + 1):
            vectors[(B + power) * n + j] += change * settings[TO_POWERS + row + power]
        if j < numbers[2]:
            most = max(most, abs(change))
    return most


@lean(STEP)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the error is the last coefficient against the largest rate."""
    rate = rate_at(functions[AT_RATE])
    n = y0.size
    m, watched, p = numbers[1], numbers[2], numbers[3]
    vectors = work[HEAD:]
    remember(t, y0, work, vectors)
    work[TRIED] = h
    if work[BEFORE] > 0.0 and h < LONGEST_RATIO * work[BEFORE]:
        predict(h / work[BEFORE], n, m, vectors, settings)
    else:
        for k in range(14 * n):
            vectors[B * n + k] = 0.0
    for i in range(DEGREE):
        for j in range(m):
            total = 0.0
            for k in range(i, DEGREE):
                total += settings[TO_NEWTON + k * DEGREE + i] * vectors[(B + k) * n + j]
            vectors[(NEWTON + i) * n + j] = total
    slope, seen = vectors[SLOPE * n : (SLOPE + 1) * n], vectors[SEEN * n : (SEEN + 1) * n]
    size = 0.0
    previous = 2.0
    for sweep in range(MOST_SWEEPS):
        change = 0.0
        for i in range(DEGREE):
            inside(i, h, y0, rate0, vectors, settings, numbers, seen, m, p)
            rate(t + settings[1 + i] * h, seen, slope, floats, ints)
            change = correct(i, m, rate0, vectors, settings, numbers, n)
        size = 0.0
        for j in range(watched):
            k = numbers[4 + j]
            size = max(size, max(abs(slope[k]), abs(rate0[k])))
        change = change / size if size > 0.0 else 0.0
        if change < CONVERGED or (sweep > 1 and change >= previous):
            break
        previous = change
    inside(DEGREE, h, y0, rate0, vectors, settings, numbers, y1, m, p)
    for k in range(n):
        vectors[END * n + k] = y1[k]
    if numbers[0] == 0:
        return 0.0
    last = 0.0
    for j in range(watched):
        last = max(last, abs(vectors[(B + DEGREE - 1) * n + j]))
    error = last / size / settings[0] if size > 0.0 else 0.0
    longest = h / SHRINKAGE
    work[NEXT] = min(longest, h * error ** (-1.0 / 7.0)) if error > 0.0 else longest
    return error * SHRINKAGE**7


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The polynomial's own integrals, up to theta."""
    n = y0.size
    m, p = numbers[1], numbers[3]
    s = h * theta
    b = work[HEAD + B * n :]
    for j in range(m):
        k = numbers[4 + j]
        once = 0.0
        for i in range(DEGREE, 0, -1):
            once = theta * (once + b[(i - 1) * n + j] / (i + 1))
        out[k] = y0[k] + s * (rate0[k] + once)
    for q in range(p):
        at, j = numbers[4 + m + q], numbers[4 + m + p + q]
        k = numbers[4 + j]
        twice = 0.0
        for i in range(DEGREE, 0, -1):
            twice = theta * (twice + b[(i - 1) * n + j] / ((i + 1) * (i + 2)))
        out[at] = y0[at] + s * (y0[k] + s * (0.5 * rate0[k] + twice))
