# mypy: ignore-errors
"""Exact events: the first contact inside a step, found on dense output, located with the solver's own step.

A pair whose gap at the step's start is at most ``slop`` touches. ``leaving[pair]`` is 1 when its impact was applied at
this very instant: then it moves apart, however shortly, and the next root is sought by deflation (the root at the
start divided out), so that bounces far shorter than the step are found one after the other.

What contact kernels may count on, and owe:
- gap: a resting pair writes 1e300 and has no events.
- impact(t, y, pair): called for the pair of an event after a rate evaluation at that very (t, y). It leaves the pair
  separating or resting, and changes nothing where the pair is separating already.
- impact(t, y, -1): called for each contact before the first step and after every accepted one, to put resting pairs in
  order; it sets floats[1] to 1 when it changed y or a flag, and the rate is evaluated afresh.
- memory (flags, tallies, times) is kept in floats and changed by impact and settle alone; what terms write there may
  be of any trial stage.
- an impact is applied when the step after it begins, so frames up to it read the flight before it.
"""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.pointers_kernels import AT_DENSE, AT_GAP, AT_RATE, AT_STEP, dense_at, gap_at, rate_at, step_at
from sceneql.system_kernels import EVENT, A, F, I, N

SAMPLES = 6
"""Places inside a step where the gaps are looked at; a body that enters and leaves between two of them is missed."""

ULP = 2.3e-16

LOCATE = types.float64(I, N, F, types.boolean, F, F, F, A, A, A, A, A, I, A, I, A)
FIRST_OF = types.Tuple((N, F))(I, N, F, F, F, A, A, A, A, A, A, I, A, I, A, A, A, I, F)


@lean_inlined
def reference(start, slop):
    """The gap that counts as contact: zero, or for a pair that touches the gap it starts with."""
    return start if start <= slop else 0.0


@lean_inlined
def entered(now, start, above, slop):
    """Whether a pair has come into contact; ``above``: it has been apart since the step's start."""
    if above > 0.0:
        return now <= reference(start, slop)
    return now < reference(start, slop) - slop


@lean(LOCATE, inner=True)
def locate(
    functions, pair, contact, deflate, t0, low, high,
    y0, rate0, y1, work, settings, numbers, floats, ints, now,
):  # fmt: skip
    """Length of the step from t0 that ends in contact, on the side where the pair is still apart; y1 is its end.

    The root of (gap - contact), divided by the length if ``deflate``, by Chandrupatla's hybrid of bisection and inverse
    quadratic interpolation (Chandrupatla 1997) on steps of the solver itself. 0: it never leaves contact. Negative:
    no contact up to -length.
    """
    step, gap = step_at(functions[AT_STEP]), gap_at(functions[AT_GAP])
    step(functions, t0, high, y0, rate0, y1, work, settings, numbers, floats, ints)
    gap(t0 + high, y1, now, floats, ints)
    f2 = now[pair] - contact
    if f2 >= 0.0:
        return -high
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
        x1 *= 1e-6
        if x1 < 1e-18 * high or t0 + x1 <= t0:
            return 0.0
    tolerance = ULP * (abs(t0) + high)
    fraction = 0.5
    while True:
        x = x1 + fraction * (x2 - x1)
        step(functions, t0, x, y0, rate0, y1, work, settings, numbers, floats, ints)
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
        return x1
    step(functions, t0, x2, y0, rate0, y1, work, settings, numbers, floats, ints)
    return x2


@lean(FIRST_OF, inner=True)
def first_of(
    functions, pair, t0, low, high, y0, rate0, y1, rate1,
    work, settings, numbers, floats, ints, start, now, above, leaving, slop,
):  # fmt: skip
    """Locate the contact of a pair and, as long as another pair is in contact even earlier, of that one."""
    rate, gap = rate_at(functions[AT_RATE]), gap_at(functions[AT_GAP])
    while True:
        touched = above[pair] == 0.0
        if touched and leaving[pair] == 0:
            return pair, 0.0
        length = locate(
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
            return (pair, length) if length > 0.0 else (-1, -length)
        pair = earlier
        high = length


@lean(EVENT, inner=True)
def find_event(
    functions, t0, h, y0, rate0, y1, rate1,
    sample, work, settings, numbers, floats, ints, gaps, leaving, slop,
):  # fmt: skip
    """First contact in the accepted step (t0, h): (pair, length of the step up to it), or (-1, h).

    With a length below h, y1 and rate1 are moved there. (pair, 0): a pair in contact presses on from the start.
    """
    dense, gap = dense_at(functions[AT_DENSE]), gap_at(functions[AT_GAP])
    pairs = leaving.size
    start = gaps[:pairs]
    now = gaps[pairs : 2 * pairs]
    above = gaps[2 * pairs :]
    gap(t0, y0, start, floats, ints)
    for pair in range(pairs):
        above[pair] = 1.0 if start[pair] > slop else 0.0
    low = 0.0
    for place in range(1, SAMPLES + 1):
        high = h * (place / SAMPLES)
        if place == SAMPLES:
            high = h
            gap(t0 + h, y1, now, floats, ints)
        else:
            dense(place / SAMPLES, h, y0, rate0, y1, rate1, work, settings, numbers, sample)
            gap(t0 + high, sample, now, floats, ints)
        found = -1
        for pair in range(pairs):
            if entered(now[pair], start[pair], above[pair], slop):
                if above[pair] == 0.0 and leaving[pair] == 0:
                    return pair, 0.0
                if found < 0:
                    found = pair
        if found >= 0:
            return first_of(
                functions, found, t0, low, high, y0, rate0, y1, rate1,
                work, settings, numbers, floats, ints, start, now, above, leaving, slop,
            )  # fmt: skip
        for pair in range(pairs):
            if now[pair] > reference(start[pair], slop) + slop:
                above[pair] = 1.0
        low = high
    return -1, h
