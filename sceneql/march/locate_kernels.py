# mypy: ignore-errors
"""Location of an event inside a step, by steps of the solver itself (events_kernels)."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_GAP, AT_RATE, AT_STEP, gap_at, rate_at, step_at
from sceneql.march.events_kernels import FIRST_OF, reference
from sceneql.system.signatures_kernels import A, F, I, N

ULP = 2.3e-16
NEARER = 0.01
"""Factor by which a short flight is sought nearer to its start: by far nearer its gap is hidden by rounding, a root."""

LOCATE = types.UniTuple(F, 2)(I, N, F, types.boolean, F, F, F, A, A, A, A, A, I, A, I, A)


@lean(LOCATE, inner=True)
def locate(
    functions, pair, contact, deflate, t0, low, high,
    y0, rate0, y1, work, settings, numbers, floats, ints, now,
):  # fmt: skip
    """Length [s] of the step from t0 up to contact, rounded to where the pair is still apart, and the step's error; y1
    is the state there.

    The root of (gap - contact), divided by the length if ``deflate``, by Chandrupatla's hybrid of bisection and inverse
    quadratic interpolation (Chandrupatla 1997) on steps of the solver itself. 0: the pair never leaves contact.
    Negative: no contact up to -length.
    """
    step, gap = step_at(functions[AT_STEP]), gap_at(functions[AT_GAP])
    error = step(functions, t0, high, y0, rate0, y1, work, settings, numbers, floats, ints)
    gap(t0 + high, y1, now, floats, ints)
    f2 = now[pair] - contact
    if f2 >= 0.0:
        return -high, error
    x2 = high
    x1 = low if low > 0.0 else high * 1e-6
    if deflate:
        f2 /= x2
    while True:
        step(functions, t0, x1, y0, rate0, y1, work, settings, numbers, floats, ints)
        gap(t0 + x1, y1, now, floats, ints)
        f1 = now[pair] - contact
        if deflate:
            f1 /= x1
        if f1 >= 0.0:
            break
        x2 = x1
        f2 = f1
        x1 *= NEARER
        if x1 < 1e-18 * high or t0 + x1 <= t0:
            # A pair that is apart at the start meets in between; one that touches never leaves.
            gap(t0, y0, now, floats, ints)
            f1 = now[pair] - contact
            if deflate or f1 <= 0.0:
                return 0.0, 0.0
            x1 = 0.0
            break
    tolerance = ULP * (abs(t0) + high)
    fraction = 0.5
    while True:
        x = x1 + fraction * (x2 - x1)
        error = step(functions, t0, x, y0, rate0, y1, work, settings, numbers, floats, ints)
        gap(t0 + x, y1, now, floats, ints)
        f = now[pair] - contact
        if deflate:
            f /= x
        if (f >= 0.0) == (f1 >= 0.0):
            x3 = x1
            f3 = f1
        else:
            x3 = x2
            f3 = f2
            x2 = x1
            f2 = f1
        x1 = x
        f1 = f
        least = tolerance / abs(x2 - x1)
        if f == 0.0 or least > 0.5:
            break
        xi = (x1 - x2) / (x3 - x2)
        phi = (f1 - f2) / (f3 - f2)
        fraction = 0.5
        if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi:
            fraction = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        fraction = min(1.0 - least, max(least, fraction))
    if f1 >= 0.0:
        return x1, error
    error = step(functions, t0, x2, y0, rate0, y1, work, settings, numbers, floats, ints)
    return x2, error


@lean(FIRST_OF, inner=True)
def first_of(
    functions, pair, t0, low, high, y0, rate0, y1, rate1,
    work, settings, numbers, floats, ints, start, now, above, leaving, slop,
):  # fmt: skip
    """Locate the contact of a pair, and then of each other pair that is found to be in contact even earlier.

    The length is negative where the step up to it has an error above 1: forces may grow without bound towards an event,
    as those on a rim that is about to lie flat, and the whole step have had no stage where they do.
    """
    rate, gap = rate_at(functions[AT_RATE]), gap_at(functions[AT_GAP])
    while True:
        touched = above[pair] == 0.0
        if touched and leaving[pair] == 0:
            return pair, 0.0
        length, error = locate(
            functions, pair, reference(start[pair], slop), touched, t0, 0.0 if touched else low, high,
            y0, rate0, y1, work, settings, numbers, floats, ints, now,
        )  # fmt: skip
        if length == 0.0:
            return pair, 0.0
        earlier = -1
        if length > 0.0:
            gap(t0 + length, y1, now, floats, ints)
            for other in range(start.size):
                if other != pair and earlier < 0 and now[other] < reference(start[other], slop) - slop:
                    earlier = other
        if earlier < 0:
            rate(t0 + math.fabs(length), y1, rate1, floats, ints)
            told = math.fabs(length) if error <= 1.0 else -math.fabs(length)
            return (pair, told) if length > 0.0 else (-1, told)
        pair = earlier
        high = length
