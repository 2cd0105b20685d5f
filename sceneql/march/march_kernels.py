# mypy: ignore-errors
"""The time loop of an island: fixed or adaptive steps, exact events, local contacts, checks of growth.

All state of a march lies in arrays of the caller, so that it can stop after any step and continue: the last accepted
step (y0, rate0 at clock[T0]; y1, rate1 at clock[T1]; swapped where counts[SWAPPED] is 1; ``work`` as the solver left
it, for dense output), ``clock`` and ``counts`` with the entries named below. An impact is applied when the step after
it begins, so that frames up to the impact show the state before it.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled import pointers_kernels as pointers
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, BACK_OFF, DENSE, FREE_MOTION, GAP, IMPACT, TIED_DRIFT, A, F, I
from sceneql.system.stepping import UNREAD

T0, T1, STEP, ERROR, LARGEST, LIMIT, SLOP, LEAST, CLOCKS = range(9)
"""Ends of the last step [s]; the step to try next, or the fixed one [s]; the last error; largest step [s]; largest |y|;
gap that counts as touching [m]; step below which even a run's start has no end [s]."""

STEPS, REJECTED, EVENTS, REPEATS, LEFT, INDEX, GRID, PENDING = range(8)
"""Tallies; impacts since time moved; steps left in this call; the entry that a failure names; grid points passed; the
pair whose impact is due (-1: none)."""

(
    ADAPTIVE,
    ORDER,
    LOCAL,
    LAST_STAGE,
    CONTROLS,
    HALVES,
    HELD,
    SWAPPED,
    ACTS,
    ALTERED,
    CRAWLED,
    SETTLES,
    WATCHED,
    SHRUNK,
    COUNTS,
) = range(8, 23)
"""Properties of solver and island (system.Stepper); whether a body rests on a local contact (channels.HOLDS); whether
the arrays of the step's start and end are swapped, as an end is the next start; whether kernels act after steps, and
whether they changed anything after the last; successive steps that have hardly moved time; 0, or if such kernels act on
samples, too, after how many steps they do (Method.settles); whether surfaces may pass one another in a whole step; how
often the next step is halved for what exact contacts did before, which fixed steps forget by and by."""

SHORTEST = 1e-3
"""Part of a fixed step below which it is not halved any more."""
LEAST_PART = 1e-9
"""The same of a step that is halved for what exact contacts do in it."""

CRAWL = 1e-12
"""Part of the time reached below which a step hardly moves it."""
MOST_CRAWLED = 2000
"""Such steps in a row, or shorter than any, after which the march is stuck: an impact or a breakpoint takes far fewer
to leave."""

REACHED, PAUSED, NOT_FINITE, GROWTH, STEP_TOO_SMALL, STUCK, CROSSING, GROWS, UNSEEN, COSTLY, MADE = range(11)

MOST_REPEATS = 100
"""Impacts for each pair at one instant before the contacts count as contradictory."""

MARCH = types.int64(I, F, F, A, A, A, A, A, A, A, I, A, I, A, I, A, I)


@lean(DENSE)
def hermite(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """Cubic Hermite interpolant of the step's ends: third order (Hairer, Norsett & Wanner 1993, eq. II.6.7)."""
    for k in range(y0.size):
        difference = y1[k] - y0[k]
        bend = (1.0 - 2.0 * theta) * difference + (theta - 1.0) * h * rate0[k] + theta * h * rate1[k]
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k] + theta * (theta - 1.0) * bend


@lean(GAP, inner=True)
def no_gap(t, y, gaps, floats, ints):
    """Stands in on an island without exact contacts."""


@lean(IMPACT, inner=True)
def no_impact(t, y, pair, floats, ints):
    """Stands in on an island without exact contacts."""


@lean(BACK_OFF, inner=True)
def no_back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Stands in on an island without local contacts."""


@lean(AFTER_STEP, inner=True)
def no_act(t0, t1, y0, rate0, y1, floats, ints):
    """Stands in on an island without kernels that act after steps."""
    return False


@lean(FREE_MOTION, inner=True)
def no_free_motion(h, y, floats, ints):
    """Stands in on an island whose motion without forces is x += h v."""


@lean(TIED_DRIFT, inner=True)
def no_tied_drift(functions, h, y0, kicked, y1, floats, ints):
    """Stands in on an island whose drifts no ties bind."""


@lean(types.void(A, A), inner=True)
def copy(source, target):
    """Copy entry by entry. As a helper, `march` would have its loop at every call; so it is with the next ones."""
    for k in range(target.size):
        target[k] = source[k]


@lean(types.int64(A, F), inner=True)
def beyond(y, limit):
    """Number of entries that are larger than the limit or not finite: one pass that vectorizes."""
    count = 0
    for k in range(y.size):
        count += not (abs(y[k]) <= limit)
    return count


@lean(types.int64(A), inner=True)
def first_bad(y):
    """Index of the first entry that is not finite, or -1."""
    for k in range(y.size):
        if not math.isfinite(y[k]):
            return k
    return -1


@lean(types.int64(A), inner=True)
def largest(y):
    """Index of the entry of largest magnitude."""
    best = 0
    for k in range(y.size):
        if abs(y[k]) > abs(y[best]):
            best = k
    return best


@lean(F(F, F, types.int64, types.boolean), inner=True)
def next_factor(error, previous, order, rejected):
    """Factor for the next step: PI control (Gustafsson 1991; the constants of Hairer, Norsett & Wanner's DOPRI5)."""
    if not math.isfinite(error):
        return 0.1
    if error > 1.0:
        return max(0.2, 0.9 * error ** (-1.0 / order))
    beta = 0.2 / order
    factor = 0.9 * max(error, 1e-10) ** (0.75 * beta - 1.0 / order) * previous**beta
    return min(1.0 if rejected else 10.0, max(0.2, factor))


@lean_inlined
def try_steps(step, functions, t0, t1, y0, rate0, y1, work, settings, numbers, floats, ints, clock, counts):
    """Step until the error is accepted: (end of the step [s], status). A fixed step is tried once, but halved where
    its equations have no solution; contacts, too, may end it before the next point of the time grid."""
    adaptive = counts[ADAPTIVE] > 0
    rejected = crossing = False
    while True:
        h = t1 - t0
        error = step(functions, t0, h, y0, rate0, y1, work, settings, numbers, floats, ints)
        if floats[channels.GROWS] != 0.0:
            return t1, GROWS
        large = beyond(y1, clock[LIMIT]) > 0
        bad = first_bad(y1) if large else -1
        if bad >= 0:
            error = math.inf
        crossing = False
        if counts[WATCHED] > 0 and bad < 0 and (error <= 1.0 or not adaptive):
            crossing = pointers.limit_at(functions[pointers.AT_LIMIT])(t1, y0, y1, floats, ints) < 1.0
            if crossing:
                error = math.inf
                bad = largest(rate0)
        if bad < 0 and (error <= 1.0 or not adaptive):
            if adaptive:
                controls = counts[CONTROLS] > 0
                clock[STEP] = work[0] if controls else h * next_factor(error, clock[ERROR], counts[ORDER], rejected)
                clock[ERROR] = max(error, 1e-4)
            if large:
                counts[INDEX] = largest(y1)
            return t1, GROWTH if large else REACHED
        counts[REJECTED] += 1
        counts[INDEX] = bad if bad >= 0 else largest(rate0)
        if counts[CONTROLS] > 0:
            h = 0.3 * h if crossing else min(work[0], 0.9 * h)
        else:
            h *= next_factor(error, 1.0, counts[ORDER], True) if adaptive else 0.5
        # A shorter step may round to the same end.
        if adaptive and not (t0 + 0.1 * h > t0 and t0 + h < t1 and h >= clock[LEAST]):
            return t1, CROSSING if crossing else STEP_TOO_SMALL
        if not adaptive and (counts[HALVES] == 0 or h < SHORTEST * clock[STEP]):
            return t1, CROSSING if crossing else NOT_FINITE
        rejected = True
        t1 = t0 + h


@lean_inlined
def apply_impact(rate, impact, settle, t, y, slope, floats, ints, leaving, counts):
    """Apply the impact that is due. Contacts may read numbers that terms write to floats for the state before it."""
    pair = counts[PENDING]
    counts[PENDING] = -1
    counts[EVENTS] += 1
    rate(t, y, slope, floats, ints)
    impact(t, y, pair, floats, ints)
    if counts[SETTLES] > 0:
        settle(t, t, y, slope, y, floats, ints)
    rate(t, y, slope, floats, ints)
    if counts[REPEATS] == 0:
        for k in range(leaving.size):
            leaving[k] = 0
    leaving[pair] = 1


@lean_inlined
def take_back(length, t0, y0, rate0, y1, rate1, clock, counts):
    """Undo a step whose retry up to an event fails, as an implicit one may; whether to try a shorter step."""
    counts[REJECTED] += 1
    counts[INDEX] = largest(rate0)
    clock[STEP] = 0.3 * length
    copy(y0, y1)
    copy(rate0, rate1)
    return counts[ADAPTIVE] > 0 and t0 + 0.1 * clock[STEP] > t0


@lean(MARCH)
def march(
    functions, target, end,
    y0, rate0, y1, rate1, sample, work, settings, numbers, floats, ints, gaps, leaving, clock, counts,
):  # fmt: skip
    """Take steps until clock[T1] >= target; the status. ``functions``: addresses (pointers_kernels).

    y0, rate0, y1, rate1, sample are of y's size; sample is left with the step's end before local contacts and kernels
    that act after steps changed it; leaving (pairs,), gaps (3 pairs,). On a failure the step is undone: (clock[T1], y1,
    rate1) is the last good state, counts[INDEX] the entry of y (STUCK: the pair) at fault.
    """
    step, rate = pointers.step_at(functions[pointers.AT_STEP]), pointers.rate_at(functions[pointers.AT_RATE])
    impact = pointers.impact_at(functions[pointers.AT_IMPACT])
    back_off = pointers.back_off_at(functions[pointers.AT_BACK_OFF])
    after_step = pointers.after_step_at(functions[pointers.AT_AFTER_STEP])
    settle = pointers.settle_at(functions[pointers.AT_SETTLE])
    n = y0.size
    alone = counts[LOCAL] == 0 and counts[ACTS] == 0
    # Where nothing asks for the rate before a step's end is settled, it is evaluated once, after that.
    later = alone and leaving.size == 0 and counts[SETTLES] > 0 and counts[LAST_STAGE] < 0
    # Whether a step may be taken back for what acts after it: not where contacts have changed more than the state.
    free = counts[LOCAL] == 0 and leaving.size == 0
    revocable = free
    while clock[T1] < target:
        if counts[LEFT] <= 0:
            return PAUSED
        counts[LEFT] -= 1
        t0, part = clock[T1], 0.5 ** counts[SHRUNK]
        y0, y1 = y1, y0
        rate0, rate1 = rate1, rate0
        counts[SWAPPED] = 1 - counts[SWAPPED]
        if counts[PENDING] >= 0:
            due = counts[PENDING]
            apply_impact(rate, impact, settle, t0, y0, rate0, floats, ints, leaving, counts)
            if floats[channels.CHANGED] <= channels.NO_WAY_ON:
                copy(y0, y1)
                copy(rate0, rate1)
                counts[INDEX] = due
                return STUCK if floats[channels.CHANGED] == channels.NO_WAY_ON else COSTLY
        if counts[ADAPTIVE] > 0:
            h = min(clock[STEP], clock[LARGEST])
            grid = end if t0 + 1.01 * h >= end else t0 + h
        else:
            grid = (counts[GRID] + 1) * clock[STEP]
            if grid > end - 1e-9 * clock[STEP]:
                grid = end
        t1, status = try_steps(
            step,
            functions,
            t0,
            t0 + part * (grid - t0) if part < 1.0 else grid,
            y0,
            rate0,
            y1,
            work,
            settings,
            numbers,
            floats,
            ints,
            clock,
            counts,
        )
        if status != REACHED:
            copy(y0, y1)
            copy(rate0, rate1)
            if leaving.size > 0 and counts[ADAPTIVE] == 0 and status in (GROWTH, NOT_FINITE) and part > LEAST_PART:
                counts[SHRUNK] += 1
                continue
            return status
        if counts[LAST_STAGE] >= 0:
            copy(work[counts[LAST_STAGE] * n :], rate1)
        elif counts[LAST_STAGE] == UNREAD:
            pass
        elif (alone and not later) or leaving.size > 0 or (counts[HELD] > 0 and counts[ORDER] > 1):
            # (Resting contacts of a first-order method may use the load at the step's start.)
            rate(t1, y1, rate1, floats, ints)
        if leaving.size > 0:
            pair, reached = pointers.event_at(functions[pointers.AT_EVENT])(
                functions, t0, t1 - t0, y0, rate0, y1, rate1,
                sample, work, settings, numbers, floats, ints, gaps, leaving, clock[SLOP],
            )  # fmt: skip
            if first_bad(y1) >= 0:
                if take_back(t1 - t0, t0, y0, rate0, y1, rate1, clock, counts):
                    continue
                return STEP_TOO_SMALL if counts[ADAPTIVE] > 0 else NOT_FINITE
            if reached < 0.0:
                reached = -reached
                if counts[ADAPTIVE] > 0 and take_back(reached, t0, y0, rate0, y1, rate1, clock, counts):
                    continue
            counts[PENDING] = pair
            if reached == 0.0:
                copy(y0, y1)
                copy(rate0, rate1)
                counts[REPEATS] += 1
                if counts[REPEATS] > MOST_REPEATS * leaving.size:
                    counts[INDEX] = pair
                    return STUCK
                continue
            counts[REPEATS] = 0
            if reached < t1 - t0:
                t1 = t0 + reached
        if counts[LOCAL] > 0:
            floats[channels.STEP_END] = t1
            back_off(t0, t1, y0, rate0, y1, floats, ints)
            if floats[channels.STEP_END] < t1:
                t1 = floats[channels.STEP_END]
                counts[PENDING] = -1
                step(functions, t0, t1 - t0, y0, rate0, y1, work, settings, numbers, floats, ints)
                if first_bad(y1) >= 0:
                    if take_back(t1 - t0, t0, y0, rate0, y1, rate1, clock, counts):
                        continue
                    return STEP_TOO_SMALL if counts[ADAPTIVE] > 0 else NOT_FINITE
                if counts[LAST_STAGE] < 0 and counts[HELD] > 0 and counts[ORDER] > 1:
                    rate(t1, y1, rate1, floats, ints)
            floats[channels.STEP_END] = floats[channels.HOLDS] = 0.0
        if counts[LOCAL] > 0 or counts[ACTS] > 0 or counts[SETTLES] > 0:
            copy(y1, sample)
        if counts[ACTS] > 0:
            floats[channels.EARLIER] = 1.0 if revocable and counts[ADAPTIVE] > 0 else 0.0
            counts[ALTERED] = after_step(t0, t1, y0, rate0, y1, floats, ints)
            asked = floats[channels.EARLIER]
            floats[channels.EARLIER] = 0.0
            # What asks once others have changed something is not heard, nor in the next step, so that it goes on.
            revocable = free and (counts[ALTERED] == 0 or not 0.0 < asked < 1.0)
            if counts[ALTERED] == 0 and 0.0 < asked < 1.0:
                copy(y0, y1)
                copy(rate0, rate1)
                counts[REJECTED] += 1
                clock[STEP] = asked * (t1 - t0)
                continue
            unknown = counts[LAST_STAGE] < 0 and leaving.size == 0
            if counts[LOCAL] == 0 and (counts[ALTERED] > 0 or unknown):
                rate(t1, y1, rate1, floats, ints)
        if counts[LOCAL] > 0:
            back_off(t0, t1, y0, rate0, y1, floats, ints)
            counts[HELD] = floats[channels.HOLDS] != 0.0
            rate(t1, y1, rate1, floats, ints)
        if leaving.size > 0:
            floats[channels.CHANGED] = channels.DUE if counts[PENDING] >= 0 else 0.0
            impact(t1, y1, -1, floats, ints)
            if floats[channels.CHANGED] <= channels.UNSEEN:
                copy(y0, y1)
                copy(rate0, rate1)
                made = floats[channels.CHANGED] == channels.MADE
                unseen = floats[channels.CHANGED] == channels.UNSEEN
                if (made or (unseen and counts[ADAPTIVE] == 0)) and part > LEAST_PART:
                    floats[channels.CHANGED] = 0.0
                    counts[PENDING] = -1
                    counts[REJECTED] += 1
                    counts[SHRUNK] += 1
                    continue
                return MADE if made else (UNSEEN if unseen else COSTLY)
            if floats[channels.CHANGED] == 1.0:
                rate(t1, y1, rate1, floats, ints)
        if counts[SETTLES] > 0:
            floats[channels.SETTLED] = counts[LOCAL] == 0 and counts[ALTERED] == 0 and counts[PENDING] < 0
            now = counts[STEPS] % counts[SETTLES] == 0 or not later
            if (now and settle(t0, t1, y0, rate0, y1, floats, ints)) or later:
                rate(t1, y1, rate1, floats, ints)
        clock[T0] = t0
        clock[T1] = t1
        counts[SHRUNK] = 0 if counts[ADAPTIVE] > 0 else max(0, counts[SHRUNK] - 1)
        counts[STEPS] += 1
        if counts[ADAPTIVE] == 0:
            counts[GRID] += t1 >= grid
        elif clock[STEP] <= max(CRAWL * t1, clock[LEAST]):
            counts[CRAWLED] += 1
            if counts[CRAWLED] > MOST_CRAWLED:
                return STEP_TOO_SMALL
        else:
            counts[CRAWLED] = 0
    return REACHED
