# mypy: ignore-errors
"""Error scales of the entries of a state, where a script gives a relative tolerance alone: from their magnitudes.

The scale of a single entry is its largest recent magnitude, halved with every step: an entry that has decayed by many
decades may still matter (in chemical kinetics it does), and one that passes through zero keeps a scale there. Entries
of a group, such as the positions of a model's masses, share the largest magnitude that any of them has had, but at most
1 in SI units, or each its own magnitude where that is larger: one mass that flies off must not relax the tolerance of
the others. Velocities have at least the scale that crosses their model's positions in a second, so that the last
vibrations of a mass coming to rest are not resolved. An entry still zero has a scale from its rate. A force that sets
in on a state at rest makes no change at the first instant, and growth as a power of time is as hard to follow in short
steps as in long ones: there the scale is the change in the first step tried, but at most 1 in SI units.

No error is required below rounding. In a group that is the rounding of the largest entry of all. A single entry may be
smaller than that by many decades, and exact (a radical beside its reagents), or be zero but for the rounding of others
(a symmetry): they are told apart by the change of its rate when all entries change by their last digits. One that only
decays is followed down to DECAYED of the largest magnitude that it has had.

``scales``: [the largest magnitude of all so far; of each group its size, its rate, the largest magnitude that it has
had, the rounding of its rate]. ``plan`` (stepping/error_scales.py): [groups, how many of the first have several
entries, how many of these are of masses (positions and velocities by turns), the group of each entry].
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.system.signatures_kernels import A, F, I

WEIGH = types.boolean(types.boolean, F, F, A, A, A, A, I, A)
EXPLICIT = types.void(I, F, F, A, A, F, A, I, A, A, I)
LARGEST, SIZES = range(2)
GROUPS, SHARED, MASSES, GROUP_OF = range(4)

KEPT = 0.5
"""Factor of an entry's scale in every step in which its magnitude is smaller."""
EARLY = 0.1
"""Part of an entry's predicted change in the next step that counts as its scale."""
WOKEN = 1e3
"""Ratio of the rates at a step's end and start above which a force is taken to set in within the step."""
ROUNDING = 1e-14
"""Error, relative to the largest entry so far, that is rounding alone."""
LAST_DIGITS = 2.0**-49
"""Relative change of the entries by which the rounding of their rates is found: eight times that of a number."""
SEEN = 8.0
"""Multiple of the effect of that change below which an error counts as rounding."""
GOLDEN = 0.6180339887498949
FORGOTTEN = 0.9
"""Part of that effect that is remembered at the next step: last digits are random."""
DECAYED = 1e-24
"""Error, relative to the largest magnitude that an entry has had, that never matters."""


@lean(WEIGH, inner=True)
def weigh(new, tolerance, h, y0, rate0, later, scales, plan, weights):
    """Write ``weights`` (n,): 1/(allowed error of each entry) in a step of length h. ``new``: y0 is a new start.

    ``later`` (n,): rates within the step, where they are known; else rate0. True where the error allowed in a single
    entry lies below the rounding of the largest of all: then `shaken` and `level` are to find its own.
    """
    groups, shared = plan[GROUPS], plan[SHARED]
    sizes, rates = scales[SIZES : SIZES + groups], scales[SIZES + groups : SIZES + 2 * groups]
    highest = scales[SIZES + 2 * groups : SIZES + 3 * groups]
    if new:
        for j in range(shared, groups):
            sizes[j] *= KEPT
    for j in range(groups):
        rates[j] = 0.0
    for k in range(y0.size):
        j, size = plan[GROUP_OF + k], abs(y0[k])
        sizes[j] = max(sizes[j], size)
        rates[j] = max(rates[j], abs(rate0[k]))
        if new and WOKEN * abs(rate0[k]) < abs(later[k]):
            sizes[j] = max(sizes[j], min(1.0, EARLY * h * abs(later[k])))
        highest[j] = max(highest[j], size)
        scales[LARGEST] = max(scales[LARGEST], size)
    for j in range(0, plan[MASSES], 2):
        sizes[j + 1] = max(sizes[j + 1], sizes[j])
    least = ROUNDING * scales[LARGEST]
    small = False
    for k in range(y0.size):
        j = plan[GROUP_OF + k]
        scale = max(sizes[j], EARLY * h * rates[j])
        if j < shared:
            allowed = max(tolerance * max(abs(y0[k]), min(1.0, scale)), least)
        else:
            allowed = max(tolerance * scale, DECAYED * highest[j])
            small = small or 1e-100 < allowed < least
        if not allowed > 1e-100:  # it is zero, and stays so at first
            allowed = least if least > 1e-100 else tolerance
        weights[k] = 1.0 / allowed
    return small


@lean_inlined
def weigh_anew(t, tolerance, h, y0, rate0, later, scales, plan, weights):
    """As `weigh`; a step from another time than the one stored last in ``scales`` has a new start."""
    last = scales.size - 1
    small = weigh(t != scales[last], tolerance, h, y0, rate0, later, scales, plan, weights)
    scales[last] = t
    return small


@lean_inlined
def shaken(functions, t, y0, rate0, scales, plan, change, moved, floats, ints):
    """Write ``change`` (n,): that of the rates when all entries change by their last digits, of late.

    ``moved``: scratch.
    """
    for k in range(y0.size):
        # By other numbers of last digits at each step: the very last may be the one that matters.
        turn = LAST_DIGITS * (0.5 + (1e7 * t + GOLDEN * k) % 1.0)
        moved[k] = y0[k] + (turn if (k * 40503 >> 4) & 1 else -turn) * y0[k]
    rate = rate_at(functions[AT_RATE])
    rate(t, moved, change, floats, ints)
    noise = scales[SIZES + 3 * plan[GROUPS] :]
    for k in range(y0.size):
        j = plan[GROUP_OF + k]
        off = change[k] - rate0[k]
        if j >= plan[SHARED] and abs(off) < math.inf:
            noise[j] = max(FORGOTTEN * noise[j], abs(off))
            off = math.copysign(noise[j], off)
        change[k] = off if abs(off) < math.inf else 0.0


@lean_inlined
def level(factor, change, scales, plan, weights):
    """Raise the allowed errors of single entries to the rounding that a step makes: ``factor * change``."""
    least = ROUNDING * scales[LARGEST]
    for k in range(weights.size):
        if plan[GROUP_OF + k] >= plan[SHARED]:
            noise = min(least, SEEN * factor * abs(change[k]))
            if noise * weights[k] > 1.0:
                weights[k] = 1.0 / noise


@lean_inlined
def copy_of(source, target):
    """Copy entry by entry."""
    for k in range(target.size):
        target[k] = source[k]


@lean_inlined
def foresee(functions, t, h, y0, rate0, scales, plan, later, moved, floats, ints):
    """Write ``later`` (n,): rate0, or the rates at the end of a step in which a force sets in on a state without scale.

    ``moved`` (n,): scratch. No rate is evaluated where rate0 gives a scale or the rate does not depend on time.
    """
    early = False
    for k in range(y0.size):
        later[k] = rate0[k]
        size = max(abs(y0[k]), scales[SIZES + plan[GROUP_OF + k]])
        early = early or size <= EARLY * h * abs(rate0[k])
    if not early:
        return
    rate = rate_at(functions[AT_RATE])
    rate(t + h, y0, later, floats, ints)
    woken = False
    for k in range(y0.size):
        woken = woken or WOKEN * abs(rate0[k]) < abs(later[k]) < math.inf
    if not woken:
        copy_of(rate0, later)
        return
    for k in range(y0.size):
        moved[k] = y0[k] + h * later[k]
    rate(t + h, moved, later, floats, ints)
    for k in range(y0.size):
        first = (moved[k] - y0[k]) / h
        later[k] = max(abs(first), abs(later[k])) if math.isfinite(later[k]) and math.isfinite(first) else rate0[k]


@lean(EXPLICIT, inner=True)
def weigh_explicitly(functions, t, h, y0, rate0, tolerance, scales, plan, scratch, floats, ints):
    """The weights for the step of an explicit method, into the first n of ``scratch`` (3 n,)."""
    n = y0.size
    weights, later, moved = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n]
    foresee(functions, t, h, y0, rate0, scales, plan, later, moved, floats, ints)
    if weigh_anew(t, tolerance, h, y0, rate0, later, scales, plan, weights):
        shaken(functions, t, y0, rate0, scales, plan, later, moved, floats, ints)
        level(h, later, scales, plan, weights)
