# mypy: ignore-errors
"""Newton's method for one implicit stage: y = base + a f(t, y), by the linear systems of stage_kernels.

Slopes are evaluated with the forces predicted by the previous update (system.Slopes), not with those at the new state:
a stiff spring that turns stretches by the square of its displacement, and that force, which vanishes with the next
update, would hide the residual across the spring (Magisano, Leonetti & Garcea 2017).

The Jacobian and its factors are kept from stage to stage and step to step as long as the iteration contracts well
(Hairer & Wanner 1996, IV.8). Where the plain iteration fails, a careful one starts: slopes are definite, and
evaluated anew for every update. Where its convergence is slow, the plain iteration is tried again from there. Where
that fails too, and on islands that have a potential at once, the way is searched (newton_search_kernels.py).

``memory`` (MEMORY,): the factored matrix's a (0: none), the previous stage's contraction; the relative and absolute
tolerance of the norm, and the share of it for the iteration's error; 1 while stages begin with the careful iteration
(the last one ended with it), and 1 if positive slopes are factored; how many systems were solved and factored so far.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.pointers_kernels import AT_ENERGY, AT_JACOBIAN, AT_LIMIT, AT_RATE, jacobian_at, limit_at, rate_at
from sceneql.linear.stage_kernels import (
    BORDER,
    CORE_AT,
    POSITIONS,
    POSITIONS_AT,
    ROUNDED,
    TALLIES,
    TALLIES_AT,
    UNKNOWNS,
    factor_stage,
    solve_stage,
)
from sceneql.system.signatures_kernels import A, F, I

FACTORED, CONTRACTION, RELATIVE, ABSOLUTE, SHARE, CAREFUL, POSITIVE, ITERATIONS, FACTORIZATIONS, MEMORY = range(10)

MOST = 25
"""Largest number of plain iterations in a stage."""
MOST_CAREFUL = 100
"""Largest number of iterations with definite slopes."""
SLOWED = 0.5
"""Contraction from which on the careful iteration is slow."""
PLAIN_AFTER = 16
"""Careful iterations after which the plain one is tried again if they are slow; twice as many if it failed there."""
HELPS = 0.7
"""Largest contraction with which that plain iteration continues."""
SLOW = 0.2
"""Contraction from which on the Jacobian is evaluated anew."""
CLEAR = 0.9
"""Share of the part of a change up to which surfaces stay apart that is taken."""
UNSEEN = 0.05
"""Least contraction that is assumed before two updates measure it."""
TINY = 0.01
"""Update, in units of the tolerance, below which a single one may end the iteration; the residual, of a field."""
LOADED, LOOSELY = 1e-3, 0.1
"""Part by which loads of friction may differ from those that the stage was solved with; the most, a hundred times the
relative tolerance."""
MOST_TURNS = 8
"""Largest number of solutions of a stage, each with the loads of the one before (Li et al. 2020, 5.5)."""
ROUNDING = 1e-12
"""Relative rounding error of a step's length."""
NOISE = 1e-4
"""Two updates in a row below this, in units of the tolerance, end the iteration: the rest is rounding."""
NOISE_APART = TINY
"""The same where surfaces are kept apart: of stiff solids that fly freely rounding leaves more."""
NEWTON = types.boolean(I, F, F, A, A, A, A, A, A, A, A, I, A, I)

search = lazy("sceneql.linear.newton_search_kernels:search", NEWTON)


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
    """The largest entry of a change in the same units: with many masses at rest a mean would hide one that diverges."""
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
    """Compute positions from their velocities: their rows are linear, and remain solved from then on."""
    at = plan[POSITIONS_AT]
    for k in range(at, at + 3 * plan[POSITIONS], 3):
        y[plan[k]] = base[plan[k]] + a * y[plan[k + 1]]


@lean_inlined
def foresee(old, new, floats):
    """Store the latest update, by which slopes predict forces (system.Slopes)."""
    before, after = floats.size - channels.BEFORE * old.size, floats.size - channels.AFTER * old.size
    for k in range(old.size):
        floats[before + k] = old[k]
        floats[after + k] = new[k]


@lean_inlined
def tell_stage(a, base, floats):
    """Store a stage's coefficient and base for the terms."""
    if floats[channels.STAGE] != channels.NO_SLOPES:
        floats[channels.STAGE] = a
        floats[channels.STAGES] += 1.0
        floats[channels.LAGS] += 1.0
        floats[channels.STALE] = 0.0
        at = floats.size - channels.BASE * base.size
        for k in range(base.size):
            floats[at + k] = base[k]


@lean_inlined
def end_stage(floats):
    """Mark the end of the stage for the terms."""
    if floats[channels.STAGE] != channels.NO_SLOPES:
        floats[channels.STAGE] = channels.OUTSIDE


@lean_inlined
def approach(functions, t, a, base, y0, y, plan, floats, ints):
    """Let positions follow the velocities of a guess, and bodies turn, no further than surfaces stay apart."""
    follow(plan, a, base, y)
    part = limit_at(functions[AT_LIMIT])(t, y0, y, floats, ints)
    if part < 1.0:
        core, at = plan[CORE_AT], plan[POSITIONS_AT]
        for k in range(core, core + plan[UNKNOWNS] - plan[BORDER]):  # quaternions among them
            y[plan[k]] = y0[plan[k]] + CLEAR * part * (y[plan[k]] - y0[plan[k]])
        for k in range(at, at + 3 * plan[POSITIONS], 3):
            y[plan[k]] = y0[plan[k]] + CLEAR * part * (y[plan[k]] - y0[plan[k]])
            y[plan[k + 1]] = (y[plan[k]] - base[plan[k]]) / a


@lean_inlined
def leave(rate, t, a, base, y, residual, plan, floats, ints):
    """Residual of the stage's equations at y; that of positions, which `follow` solves, is rounding alone."""
    follow(plan, a, base, y)
    rate(t, y, residual, floats, ints)
    for k in range(y.size):
        residual[k] = base[k] + a * residual[k] - y[k]
    at = plan[POSITIONS_AT]
    for k in range(at, at + 3 * plan[POSITIONS], 3):
        residual[plan[k]] = 0.0


@lean_inlined
def same(factored, a, plan):
    """Whether the factors are of this a: where the plan says so, also where it is another by rounding, as a step's."""
    return factored == a or (plan[ROUNDED] == 1 and abs(factored - a) <= ROUNDING * a)


@lean_inlined
def unlike(memory):
    """The part by which loads of friction may differ from those that the stage was solved with."""
    return min(LOOSELY, max(LOADED, 100.0 * memory[RELATIVE] * max(1.0, memory[SHARE])))


@lean_inlined
def remain(functions, t, a, base, y, residual, plan, floats, ints):
    """What `leave` does. Where surfaces are kept apart, and on elements of fields, tallies, on which nothing depends,
    follow: the work of an impact, or the heat that flowed in, would be the last to converge."""
    leave(rate_at(functions[AT_RATE]), t, a, base, y, residual, plan, floats, ints)
    if functions[AT_LIMIT] != 0 or plan[ROUNDED] == 1:
        for k in range(plan[TALLIES_AT], plan[TALLIES_AT] + plan[TALLIES]):
            y[plan[k]] += residual[plan[k]]
            residual[plan[k]] = 0.0


@lean(NEWTON, inner=True)
def converge(functions, t, a, base, y0, y, scratch, jacobian, store, scales, memory, plan, floats, ints):
    """Solve for y with the loads of friction that are known."""
    slopes = jacobian_at(functions[AT_JACOBIAN])
    n = y.size
    change, residual, guess = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n]
    if functions[AT_LIMIT] != 0:
        approach(functions, t, a, base, y0, y, plan, floats, ints)
    for k in range(n):
        guess[k] = y[k]
    careful = definite = memory[CAREFUL] > 0.0
    stale = memory[FACTORED] == 0.0 or definite or memory[POSITIVE] > 0.0
    searches = functions[AT_ENERGY] != 0 or functions[AT_LIMIT] != 0
    noise = NOISE_APART if functions[AT_LIMIT] != 0 else NOISE
    before, before_mean = 0.0, 0.0
    patience, limit = PLAIN_AFTER, 1.0
    iteration = since = 0
    remain(functions, t, a, base, y, residual, plan, floats, ints)
    while iteration < MOST or (careful and iteration < MOST_CAREFUL):
        if definite and searches:
            break
        memory[ITERATIONS] += 1.0
        if stale:
            floats[channels.NEWTON] = a * a
            floats[channels.POSITIVE] = memory[POSITIVE] = 1.0 if definite else 0.0
            slopes(functions, t, y, jacobian, floats, ints)
            floats[channels.NEWTON] = floats[channels.POSITIVE] = 0.0
            if floats[channels.GROWS] != 0.0:
                return False
        size = math.inf
        regular = True
        if stale or not same(memory[FACTORED], a, plan):
            memory[FACTORED] = a
            memory[FACTORIZATIONS] += 1.0
            regular = factor_stage(plan, a, jacobian, scales, store)
        contraction = max(UNSEEN, memory[CONTRACTION])
        if regular:
            for k in range(n):
                change[k] = residual[k]
            regular = solve_stage(plan, a, jacobian, scales, store, change)
        if regular:
            for k in range(n):
                change[k] += y[k]
            if functions[AT_LIMIT] != 0:
                follow(plan, a, base, change)
                regular = limit_at(functions[AT_LIMIT])(t, y, change, floats, ints) == 1.0
        if regular:
            foresee(y, change, floats)
            for k in range(n):
                y[k], change[k] = change[k], change[k] - y[k]
            remain(functions, t, a, base, y, residual, plan, floats, ints)
            size = largest(change, y0, y, memory)
        mean = norm(change, y0, y, memory) if size < math.inf else math.inf
        if size < math.inf and since > 0:
            contraction = size / before if before > 0.0 else 0.0
            memory[CONTRACTION] = max(contraction, 1e-3)
        done = size == 0.0 or (contraction < 1.0 and size * contraction <= memory[SHARE] * (1.0 - contraction))
        # Steps of a given length have no other error estimate: there, the contraction must come from two updates.
        done = done and (since > 0 or memory[SHARE] < 1.0 or size < TINY)
        done = done or (since > 0 and max(size, before) <= noise)
        # Fields damp, or grow by far less than 1/TINY in a stage: the next change is not much beyond what is left now.
        if plan[ROUNDED] == 1 and not done and size < math.inf:
            done = largest(residual, y0, y, memory) <= TINY
        # Where a few masses still buckle, by less than the tolerance, the largest update does not predict the next.
        if careful and since > 0 and size <= memory[SHARE]:
            done = done or mean * mean <= memory[SHARE] * (before_mean - mean)
        if done:
            if not definite:
                memory[CAREFUL] = 0.0
            return True
        iteration += 1
        since += 1
        if not size < math.inf or (not definite and since > 1 and contraction >= limit):
            # The plain iteration fails: restart from the guess with the careful one.
            memory[FACTORED] = 0.0
            if definite:
                break
            memory[CAREFUL] = limit = 1.0
            careful = definite = stale = True
            for k in range(n):
                y[k] = guess[k]
            foresee(y0, y0, floats)
            remain(functions, t, a, base, y, residual, plan, floats, ints)
            since = 0
            continue
        # A stretched spring hides the residual across it: slopes of an earlier state do not predict the next update.
        stale = definite or (since > 1 and contraction > SLOW and size > noise)
        if stale and since > 1:
            memory[CONTRACTION] = 1.0
        if definite and since >= patience and contraction > SLOWED:
            for k in range(n):
                guess[k] = y[k]
            definite, stale, since = False, True, 0
            limit = HELPS
            patience *= 2
        before, before_mean = size, mean
    for k in range(n):
        y[k] = guess[k]
    return search(functions, t, a, base, y0, y, scratch, jacobian, store, scales, memory, plan, floats, ints)


@lean(NEWTON, inner=True)
def newton(functions, t, a, base, y0, y, scratch, jacobian, store, scales, memory, plan, floats, ints):
    """Solve for y, which comes as a guess; True if the iteration converged. ``scratch``: (4 n,).

    ``jacobian`` (room of the pattern) and ``store`` (of the plan) keep values and factors between calls.
    """
    tell_stage(a, base, floats)
    foresee(y0, y0, floats)
    found = False
    for turn in range(MOST_TURNS):
        if turn == MOST_TURNS - 1:
            floats[channels.STALE] = 0.0
        found = converge(functions, t, a, base, y0, y, scratch, jacobian, store, scales, memory, plan, floats, ints)
        if not found or floats[channels.STALE] <= unlike(memory):
            break
        foresee(y, y, floats)
        floats[channels.LAGS] += 1.0
        floats[channels.STALE] = 0.0
        rate_at(functions[AT_RATE])(t, y, scratch[: y.size], floats, ints)
    end_stage(floats)
    if not found:
        fail(scratch[: y.size], y)
    return found
