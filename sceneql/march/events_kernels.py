# mypy: ignore-errors
"""Exact events: the first contact inside a step, found on dense output, located with the solver's own step.

The code that locates an event is compiled at the first one (locate_kernels).

A pair whose gap at the step's start is at most ``slop`` touches. ``leaving[pair]`` is 1 when its impact was applied at
this very instant: then the pair separates, however briefly, and the next root is sought by deflation (the root at the
start divided out), so that bounces far shorter than the step are found one after the other.

The contract of contact kernels:
- gap: a resting pair writes 1e300 and has no events.
- impact(t, y, pair): called for the pair of an event after a rate evaluation at that very (t, y). It leaves the pair
  separating or resting, and changes nothing where the pair is separating already.
- impact(t, y, -1): called for each contact before the first step and after every accepted one, to update resting
  pairs; it sets channels.CHANGED when it changed y or a flag, and the rate is evaluated anew.
- memory (flags, tallies, times) is kept in floats and changed by impact and back_off alone; numbers that terms write
  there may belong to any trial stage.
- an impact is applied when the step after it begins, so frames up to its instant show the flight before it.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.pointers_kernels import AT_DENSE, AT_GAP, dense_at, gap_at
from sceneql.system.signatures_kernels import EVENT, A, F, I, N

SAMPLES = 6
"""Samples of the gaps inside a step; a body that enters and leaves between two samples is missed."""

FIRST_OF = types.Tuple((N, F))(I, N, F, F, F, A, A, A, A, A, A, I, A, I, A, A, A, I, F)

first_of = lazy("sceneql.march.locate_kernels:first_of", FIRST_OF)


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


@lean(EVENT, inner=True)
def find_event(
    functions, t0, h, y0, rate0, y1, rate1,
    sample, work, settings, numbers, floats, ints, gaps, leaving, slop,
):  # fmt: skip
    """First contact in the accepted step (t0, h): (pair, length of the step up to it), or (-1, h).

    With a length below h, y1 and rate1 are those at the contact. (pair, 0): a touching pair approaches at the start. A
    negative length: the step of this length has an error above 1.
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
