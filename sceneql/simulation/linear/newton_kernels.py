# mypy: ignore-errors
"""Newton's method for one implicit stage: y = base + a f(t, y), by the linear systems of stage_kernels.

The Jacobian and its factors are kept from stage to stage and step to step as long as the iteration contracts well
(Hairer & Wanner 1996, IV.8). Where the plain iteration fails it begins again with definite slopes and a line search:
a change that overshoots is cut where the residual does no work on it (Matthies & Strang 1979; Baraff & Witkin 1998).
That converges from far, but slowly; so the plain iteration is tried again from there, and ends it.

``memory`` (MEMORY,): the a that is factored (0: none), the contraction of last time; the relative and absolute
tolerance of the norm, and the part of it that the iteration's own error may take; 1 while stages begin with definite
slopes (the last one ended with them), and 1 if those are factored.
"""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.linear.stage_kernels import (
    CORE_AT,
    POSITIONS,
    POSITIONS_AT,
    SYMMETRIC,
    UNKNOWNS,
    factor_stage,
    solve_stage,
)
from sceneql.simulation.pointers_kernels import AT_JACOBIAN, AT_RATE, jacobian_at, rate_at
from sceneql.system_kernels import A, F, I

FACTORED, CONTRACTION, RELATIVE, ABSOLUTE, SHARE, CAREFUL, DEFINITE, MEMORY = range(8)
DEFINITE_AT = 2
"""floats[2]: whether slopes are to be definite, and how far (system.Slopes)."""

MOST = 25
"""Iterations of a plain stage."""
MOST_CAREFUL = 100
"""Those of one with definite slopes."""
PLAIN_AFTER = 30
"""Careful iterations after which the plain one is tried again; twice as many after it failed there."""
HELPS = 0.7
"""Contraction that the plain iteration needs there."""
SLOW = 0.2
"""Contraction from which on the Jacobian is evaluated anew."""
UNSEEN = 0.05
"""Contraction that is believed before there are two changes to tell it by."""
TINY = 0.01
"""Change, in units of the tolerance, that is believed to be the last one by itself."""
OVERSHOT = 0.9
"""Part of its work at the start that the residual may do against a change at its end."""
CUTS = 8
HOLDS = 0.1
"""Part of what inertia holds in a stage that definite slopes may push away, by each spring: all of a mass together
seldom push more than inertia and the other springs hold. Without it buckled cloth converges but linearly."""
NOTHING = 1e-300
"""In its place where they do push more."""

NEWTON = types.boolean(I, F, F, A, A, A, A, A, A, A, A, I, A, I)


@lean_inlined
def norm(change, y0, y1, memory):
    """Root mean square of a change, each entry in units of its tolerance (Hairer, Norsett & Wanner 1993, II.4.11)."""
    total = 0.0
    for k in range(y0.size):
        part = change[k] / (memory[ABSOLUTE] + memory[RELATIVE] * max(abs(y0[k]), abs(y1[k])))
        total += part * part
    return math.sqrt(total / y0.size)


@lean_inlined
def largest(change, y0, y1, memory):
    """The largest entry of a change in the same units: where many masses rest, a mean would hide one that runs off."""
    most = 0.0
    for k in range(y0.size):
        part = abs(change[k]) / (memory[ABSOLUTE] + memory[RELATIVE] * max(abs(y0[k]), abs(y1[k])))
        if not part < math.inf:
            return math.inf
        most = max(most, part)
    return most


@lean_inlined
def fail(change, y):
    """Mark the entry of y that is worst, so that the march rejects the step and a failure names it."""
    worst = 0
    for k in range(y.size):
        if not abs(change[k]) <= abs(change[worst]):
            worst = k
    y[worst] = math.nan


@lean_inlined
def follow(plan, a, base, y):
    """Positions as their velocities have it: their rows are linear, and solved from then on."""
    at = plan[POSITIONS_AT]
    for k in range(at, at + 3 * plan[POSITIONS], 3):
        y[plan[k]] = base[plan[k]] + a * y[plan[k + 1]]


@lean_inlined
def work_on(change, residual, scales, plan):
    """The work of a residual on a change."""
    core = plan[CORE_AT]
    total = 0.0
    for k in range(plan[UNKNOWNS]):
        i = plan[core + k]
        total += scales[k] * change[i] * residual[i]
    return total


@lean_inlined
def leave(rate, t, a, base, y, residual, floats, ints):
    """What is left of the stage's equations at y."""
    rate(t, y, residual, floats, ints)
    for k in range(y.size):
        residual[k] = base[k] + a * residual[k] - y[k]


@lean_inlined
def go(rate, t, a, base, y, change, residual, scales, plan, floats, ints):
    """y + s change and what is left there; s <= 1 where the change by itself overshoots."""
    before = work_on(change, residual, scales, plan)
    for k in range(y.size):
        y[k] += change[k]
    leave(rate, t, a, base, y, residual, floats, ints)
    low, high, part = 0.0, 1.0, 1.0
    low_work, work = before, work_on(change, residual, scales, plan)
    high_work = work
    for _ in range(CUTS):
        if not (work < -OVERSHOT * before or (work > OVERSHOT * before and part < 1.0)):
            break
        if work < 0.0:
            high, high_work = part, work
        else:
            low, low_work = part, work
        fall = low_work - high_work
        ahead = low + (high - low) * (min(0.9, max(0.1, low_work / fall)) if fall != 0.0 else 0.5)
        for k in range(y.size):
            y[k] += (ahead - part) * change[k]
        part = ahead
        leave(rate, t, a, base, y, residual, floats, ints)
        work = work_on(change, residual, scales, plan)
    return part


@lean(NEWTON, inner=True)
def newton(functions, t, a, base, y0, y, scratch, jacobian, store, scales, memory, plan, floats, ints):
    """Solve for y, which comes as a guess; True if the iteration converged. ``scratch``: (3 n,).

    ``jacobian`` (room of the pattern) and ``store`` (of the plan) keep values and factors between calls.
    """
    rate, slopes = rate_at(functions[AT_RATE]), jacobian_at(functions[AT_JACOBIAN])
    n = y.size
    change, residual, guess = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n]
    follow(plan, a, base, y)
    for k in range(n):
        guess[k] = y[k]
    definite = memory[CAREFUL] > 0.0
    stale = memory[FACTORED] == 0.0 or definite or memory[DEFINITE] > 0.0
    before = 0.0
    patience, limit = PLAIN_AFTER, 1.0
    holds = HOLDS / (a * a)
    iteration = since = 0
    leave(rate, t, a, base, y, residual, floats, ints)
    while iteration < MOST or (memory[CAREFUL] > 0.0 and iteration < MOST_CAREFUL):
        if stale:
            floats[DEFINITE_AT] = holds if definite else 0.0
            slopes(functions, t, y, jacobian, floats, ints)
            floats[DEFINITE_AT] = 0.0
            memory[DEFINITE] = 1.0 if definite else 0.0
        size = math.inf
        regular = True
        if stale or memory[FACTORED] != a:
            memory[FACTORED] = a
            regular = factor_stage(plan, a, jacobian, scales, store)
        contraction = max(UNSEEN, memory[CONTRACTION])
        part = 1.0
        if regular:
            for k in range(n):
                change[k] = residual[k]
            regular = solve_stage(plan, a, jacobian, scales, store, change)
        # The work on a change below the tolerance is that of rounding, which grows with the stiffness: it says nothing.
        far = regular and definite and plan[SYMMETRIC] == 1
        far = far and not largest(change, y0, y, memory) <= memory[SHARE]
        if far and holds > NOTHING and work_on(change, residual, scales, plan) <= 0.0:
            holds = NOTHING
            iteration += 1
            continue
        if regular:
            if far:
                part = go(rate, t, a, base, y, change, residual, scales, plan, floats, ints)
            else:
                for k in range(n):
                    y[k] += change[k]
                leave(rate, t, a, base, y, residual, floats, ints)
            size = part * largest(change, y0, y, memory)
        if size < math.inf and since > 0:
            contraction = size / before if before > 0.0 else 0.0
            memory[CONTRACTION] = max(contraction, 1e-3)
        done = size == 0.0 or (contraction < 1.0 and size * contraction <= memory[SHARE] * (1.0 - contraction))
        # Steps of a given length have no estimate of their error beside this one: there, two changes have to tell it.
        done = done and (since > 0 or memory[SHARE] < 1.0 or size < TINY)
        if done and part == 1.0:
            if not definite:
                memory[CAREFUL] = 0.0
            return True
        iteration += 1
        since += 1
        if not size < math.inf or (not definite and since > 1 and contraction >= limit):
            # The plain iteration fails: once more from the guess, with care.
            memory[FACTORED] = 0.0
            if definite:
                break
            memory[CAREFUL] = limit = 1.0
            definite = stale = True
            for k in range(n):
                y[k] = guess[k]
            leave(rate, t, a, base, y, residual, floats, ints)
            since = 0
            continue
        # A stretched spring hides what is left across it: slopes from before a change say little of the next one.
        stale = definite or (since > 1 and contraction > SLOW)
        if stale and since > 1:
            memory[CONTRACTION] = 1.0
        if definite and since > patience and part == 1.0:
            for k in range(n):
                guess[k] = y[k]
            definite, stale, since = False, True, 0
            limit = HELPS
            patience *= 2
        before = size
    memory[FACTORED] = 0.0
    fail(change, y)
    return False
