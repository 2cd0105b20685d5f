# mypy: ignore-errors
"""What the entries of a state are measured by where a script gives but a relative tolerance: by how large they are.

An entry that stands for itself counts by its largest magnitude of late, half of which is forgotten with every step:
what has decayed by many decades may still matter (in chemical kinetics it does), and an entry that passes through zero
does not count for nothing there. Entries that belong together, such as the positions of a model's masses, all count
by the largest that any of them has ever been, or by 1 in SI units where that is less, or by its own size where it is
more: one mass that flies off must not blur the others. Velocities count at least by what crosses their model's
positions in a second: what comes to rest must not be followed through the last of its vibrations. Before an entry has
any size, what its rate will make of it tells. Where a force sets in on a state at rest that is nothing for the first
instant, and what grows as a power of the time is as hard to follow in short steps as in long ones: there what the step
that is tried first makes of it counts, or 1 in SI units where that is less. No error is asked for below the rounding of
the largest entry.

``scales``: [the largest magnitude of all so far, the size of each group, its rate]. ``plan``
(stepping/error_scales.py): [groups, how many of the first have several entries, how many of these are of masses
(positions and velocities by turns), the group of each entry].
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.system.signatures_kernels import A, F, I

WEIGH = types.void(types.boolean, F, F, A, A, A, A, I, A)
LARGEST, SIZES = range(2)
GROUPS, SHARED, MASSES, GROUP_OF = range(4)

KEPT = 0.5
"""Part of its size that an entry keeps with every step that it is smaller."""
EARLY = 0.1
"""Part of what a rate makes of an entry in the step ahead that counts as its size."""
WOKEN = 1e3
"""Times the rate at the start that one at the end is where the time wakes it."""
ROUNDING = 1e-14
"""Error, in units of the largest entry so far, below which there is but rounding."""


@lean(WEIGH, inner=True)
def weigh(new, tolerance, h, y0, rate0, later, scales, plan, weights):
    """``weights`` (n,): one by the error allowed to each entry in a step of length h. ``new``: the start is another.

    ``later`` (n,): rates within the step, where they are known; else rate0.
    """
    groups, shared = plan[GROUPS], plan[SHARED]
    sizes, rates = scales[SIZES : SIZES + groups], scales[SIZES + groups : SIZES + 2 * groups]
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
        scales[LARGEST] = max(scales[LARGEST], size)
    for j in range(0, plan[MASSES], 2):
        sizes[j + 1] = max(sizes[j + 1], sizes[j])
    least = ROUNDING * scales[LARGEST]
    for k in range(y0.size):
        j = plan[GROUP_OF + k]
        scale = max(sizes[j], EARLY * h * rates[j])
        if j < shared:
            scale = max(abs(y0[k]), min(1.0, scale))
        # Of a state that is all zero and stays so nothing is known.
        allowed = max(tolerance * scale, least)
        weights[k] = 1.0 / (allowed if allowed > 1e-100 else tolerance)


@lean_inlined
def weigh_anew(t, tolerance, h, y0, rate0, later, scales, plan, weights):
    """As `weigh`; a step from another time than that in the last of ``scales`` is a new one."""
    last = scales.size - 1
    weigh(t != scales[last], tolerance, h, y0, rate0, later, scales, plan, weights)
    scales[last] = t


@lean_inlined
def copy_of(source, target):
    """Entry by entry."""
    for k in range(target.size):
        target[k] = source[k]


@lean_inlined
def foresee(functions, t, h, y0, rate0, scales, plan, later, moved, floats, ints):
    """``later`` (n,): rate0, or what the rates are at the end of a step in which the time wakes a state without a size.

    ``moved`` (n,): scratch. What rate0 itself foretells needs no look, nor does a rate that does not read the time.
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
