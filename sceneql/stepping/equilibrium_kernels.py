# mypy: ignore-errors
"""Rest: the places where all forces are zero, as the loads change in time.

A state of rest is a step of implicit Euler from rest that is long beside all periods, x = x0 + a^2 F(x)/m, whose
inertia m/a^2 keeps motions that nothing resists where they are; repeated until nothing moves. `relax` comes to rest
from afar by steps that grow: each goes down the potential (pseudo-transient continuation: Kelley & Keyes 1998, SIAM J.
Numer. Anal. 35, 508-523). `step` follows a path of rests: each update is such a long step from the state before it,
slopes have the forces that the update before predicted (channels.NEWTON), and none is accepted that leaves the tangent,
so that it does not leap to another branch where a path has turned back.

``settings``: the memory of Newton's method (newton_kernels), a [s] at which the matrix's inertia outweighs its rounding
alone, what ended the latest step, how many short steps were taken in a row, what ended the latest that was not; then
the scales of the stage plan. ``numbers``: [entries of the Jacobian's room,
where the plan starts, numbers of velocities, of tallies], velocities, tallies, the stage plan. ``work``: the step to
try next, in an array of y's size; base; the rest before; scratch (4); the Jacobian; the store.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_JACOBIAN, AT_RATE, jacobian_at, rate_at
from sceneql.linear.newton_kernels import (
    CAREFUL,
    FACTORED,
    FACTORIZATIONS,
    ITERATIONS,
    MEMORY,
    follow,
    foresee,
    largest,
    leave,
    newton,
)
from sceneql.linear.stage_kernels import (
    CORE_AT,
    DIAGONAL_AT,
    INERTIA,
    INERTIA_AT,
    POSITIONS,
    POSITIONS_AT,
    UNIT,
    UNKNOWNS,
    assemble,
    factor_stage,
    indefinite,
    solve_stage,
)
from sceneql.system.signatures_kernels import STEP, A, F, I

ROOM, PLAN_AT, VELOCITIES, TALLIES, HEAD = range(5)
SIGN, ENDED, CRAWLED, CAUSE = range(MEMORY, MEMORY + 4)
SCALES_AT = MEMORY + 4
ARRAYS = 7
REACHED, ASTRAY, UNSTABLE, ON_THE_WAY = range(4)
"""What ended a step: a rest; updates that did not converge near the tangent; a rest that is unstable. `relax` is on the
way after each of its steps, so that a run may be told of signals and limits of time there."""
LENGTH, FAILED, PASSED, PUSHED, PROGRESS = range(5)
"""The progress of `relax`: a [s] of its next step, or 0 at its start; counts of failures, passes and pushes."""

FIRST, LONG = 0.01, 100.0
"""First and last a [s] of the steps to a rest."""
LONGEST = 1e6
"""The largest a [s], where motions are so slow that LONG is not beside their periods."""
FASTER = 4.0
REGULAR = 1e-12
"""Inertia beside the largest stiffness: more than its rounding, less than what bends most easily."""
FAILURES = 40
PUSH, PUSHES = 1e-3, 3
"""Part of its size by which what is at an unstable rest is moved, and how often."""
PASSES = 30
EASY = 7
"""Updates of a step after which the next one is twice as long."""
MOST = 12
"""Updates of a step along a path."""
CONVERGES = 0.6
"""Largest contraction of its updates."""
BENDS = 0.5
"""Part of the first update by which all later ones together may change it."""
NUDGE = 1e-6
"""Part of the way of what is led by which it moves to see what that does."""
SHORT, MOST_SHORT = 1e-9, 40
"""Part of the time reached by which a step is short, and how many in a row end the path: beside a limit load, and where
a column begins to buckle, every step that is short enough still finds a rest."""
COARSE = 1e3
"""Update, in units of the tolerance, below which its direction is rounding."""
ROUNDING, STALLS = 100.0, 2
"""Update, in units of the tolerance, below which so many in a row that do not contract are rounding: it is all that
forces tell of places where some are stiffer than others by many orders, as against a change of volume."""

RELAX = types.int64(I, F, A, A, A, A, I, A, I)


@lean_inlined
def at_rest(y, kept, numbers):
    """Set velocities to 0 and tallies to what they were."""
    for k in range(HEAD, HEAD + numbers[VELOCITIES]):
        y[numbers[k]] = 0.0
    for k in range(HEAD + numbers[VELOCITIES], HEAD + numbers[VELOCITIES] + numbers[TALLIES]):
        y[numbers[k]] = kept[numbers[k]]


@lean_inlined
def from_rest(rest, plan, base, y):
    """The base of a stage from rest, and its first guess y."""
    for k in range(base.size):
        base[k] = y[k] = rest[k]
    for k in range(plan[CORE_AT], plan[CORE_AT] + plan[UNKNOWNS]):
        base[plan[k]] = 0.0


@lean_inlined
def place(rate, t, rest, off, plan, floats, ints):
    """Move what is led to its places at t, in a state without velocities; ``off``: scratch."""
    floats[channels.STATIC] = channels.PLACING
    rate(t, rest, off, floats, ints)
    floats[channels.STATIC] = channels.RESTING
    at = plan[POSITIONS_AT]
    for k in range(at, at + 3 * plan[POSITIONS], 3):
        rest[plan[k]] += off[plan[k]]


@lean_inlined
def lead(rate, t, a, rest, led, base, y, residual, scratch, plan, floats, ints):
    """Add to a residual at rest, with y of `from_rest`, its change to first order as places move to those of ``led``.

    What is moved alone strains its neighbors by all of its way: volumes of what is nearly incompressible then resist
    with forces far beyond those of any rest, by which the path was followed in steps of a thousandth of a strain.
    """
    moves = False
    for k in range(y.size):
        moves = moves or led[k] != rest[k]
    if not moves:
        return
    for k in range(y.size):
        base[k] += NUDGE * (led[k] - rest[k])
    leave(rate, t, a, base, y, scratch, plan, floats, ints)
    for k in range(y.size):
        residual[k] += (scratch[k] - residual[k]) / NUDGE
    from_rest(rest, plan, base, y)


@lean_inlined
def longest(plan, jacobian, scales, store):
    """The a [s] at which inertia is REGULAR of the largest stiffness of a mass, by its own."""
    unit, at, m, most = plan[UNIT], plan[DIAGONAL_AT], plan[UNKNOWNS], 0.0
    assemble(plan, 1.0, jacobian, scales, store)
    mass = store[store.size - m :]
    for k in range(m):
        mass[k] = 0.0 if plan[INERTIA] > 0 and scales[m + k] >= 0.0 else scales[k]
    for k in range(plan[INERTIA]):
        row = plan[INERTIA_AT] + 3 * k
        if plan[row + 1] == plan[row + 2]:
            mass[plan[row + 1]] += scales[2 * m + k]
    for k in range(m):
        inside = k % unit
        stiff = store[(plan[at + k // unit] * unit + inside) * unit + inside] - mass[k]
        if mass[k] > 0.0:
            most = max(most, stiff / mass[k])
    return 1.0 / math.sqrt(REGULAR * most) if most > 0.0 else LONG


@lean_inlined
def unstable(functions, t, y, jacobian, store, settings, plan, floats, ints):
    """Whether a rest is no least of the potential: a negative eigenvalue, beyond rounding."""
    scales = settings[SCALES_AT:]
    jacobian_at(functions[AT_JACOBIAN])(functions, t, y, jacobian, floats, ints)
    settings[FACTORED] = 0.0
    settings[FACTORIZATIONS] += 1.0
    if settings[SIGN] == 0.0:
        settings[SIGN] = longest(plan, jacobian, scales, store)
    return not factor_stage(plan, settings[SIGN], jacobian, scales, store) or indefinite(plan, store)


@lean_inlined
def push(rest, plan):
    """Move places a little, ever the same, off a rest that is unstable."""
    at, count, size = plan[POSITIONS_AT], plan[POSITIONS], 0.0
    core = plan[CORE_AT]
    for k in range(at, at + 3 * count, 3):
        size = max(size, abs(rest[plan[k]] - rest[plan[at]]))
    k = 0
    for i in range(plan[UNKNOWNS]):
        while k < count and plan[at + 3 * k + 1] != plan[core + i]:
            k += 1
        if k == count:
            k = 0
            continue
        rest[plan[at + 3 * k]] += PUSH * size * math.sin(12.9898 * (i + 1.0) * (i + 1.0))


@lean(RELAX)
def relax(functions, t, y, progress, work, settings, numbers, floats, ints):
    """One step to rest from any state, until all forces are zero; REACHED, ASTRAY, UNSTABLE or ON_THE_WAY.

    ``progress`` and ``work`` are kept from call to call.
    """
    n = y.size
    base, rest, scratch = work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 7 * n]
    jacobian = work[ARRAYS * n : ARRAYS * n + numbers[ROOM]]
    store = work[ARRAYS * n + numbers[ROOM] :]
    scales, plan = settings[SCALES_AT:], numbers[numbers[PLAN_AT] :]
    if progress[LENGTH] == 0.0:
        for k in range(n):
            rest[k] = y[k]
        at_rest(rest, rest, numbers)
        place(rate_at(functions[AT_RATE]), t, rest, scratch[:n], plan, floats, ints)
        progress[LENGTH] = FIRST
    a = progress[LENGTH]
    if a < LONG:
        settings[CAREFUL] = 1.0  # plain updates may come to rest on a saddle
    from_rest(rest, plan, base, y)
    if not newton(functions, t, a, base, rest, y, scratch, jacobian, store, scales, settings, plan, floats, ints):
        progress[FAILED] += 1.0
        progress[LENGTH] = a / FASTER
        return ASTRAY if progress[FAILED] > FAILURES else ON_THE_WAY
    at_rest(y, rest, numbers)
    for k in range(n):
        scratch[k] = y[k] - rest[k]
    moved = largest(scratch[:n], rest, y, settings)
    for k in range(n):
        rest[k] = y[k]
    if a < LONG:
        progress[LENGTH] = FASTER * a
        return ON_THE_WAY
    if moved <= 1.0:
        if not unstable(functions, t, y, jacobian, store, settings, plan, floats, ints):
            return REACHED
        if progress[PUSHED] == PUSHES:
            return UNSTABLE
        push(rest, plan)
        progress[PUSHED] += 1.0
        progress[PASSED], progress[LENGTH] = 0.0, FIRST
        return ON_THE_WAY
    progress[PASSED] += 1.0
    if progress[PASSED] > 4.0:
        progress[LENGTH] = min(LONGEST, FASTER * a)
    return ASTRAY if progress[PASSED] == PASSES else ON_THE_WAY


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1, the rest at t + h on the path of y0; infinite where it is not found there.

    Each update is one of rest itself: the inertia is that of a step from the state before the update, and vanishes.
    """
    n = y0.size
    base, rest, scratch = work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 7 * n]
    jacobian = work[ARRAYS * n : ARRAYS * n + numbers[ROOM]]
    store = work[ARRAYS * n + numbers[ROOM] :]
    scales, plan = settings[SCALES_AT:], numbers[numbers[PLAN_AT] :]
    rate, slopes = rate_at(functions[AT_RATE]), jacobian_at(functions[AT_JACOBIAN])
    change, residual, tangent, own = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n], scratch[3 * n :]
    end = t + h
    settings[CAREFUL] = 0.0
    settings[ENDED] = ASTRAY
    for k in range(n):
        rest[k] = tangent[k] = y0[k]
    place(rate, end, tangent, own, plan, floats, ints)
    foresee(rest, rest, floats)
    before = first = 0.0
    updates, stalls, reached = 0, 0, False
    while updates < MOST:
        if settings[SIGN] == 0.0:
            slopes(functions, end, rest, jacobian, floats, ints)
            settings[SIGN] = longest(plan, jacobian, scales, store)
        a = settings[SIGN]
        from_rest(rest, plan, base, y1)
        leave(rate, end, a, base, y1, residual, plan, floats, ints)
        if updates == 0:
            lead(rate, end, a, rest, tangent, base, y1, residual, own, plan, floats, ints)
        floats[channels.NEWTON] = a * a
        slopes(functions, end, y1, jacobian, floats, ints)
        floats[channels.NEWTON] = 0.0
        settings[FACTORED] = 0.0
        settings[ITERATIONS] += 1.0
        settings[FACTORIZATIONS] += 1.0
        for k in range(n):
            change[k] = residual[k]
        for k in range(HEAD + numbers[VELOCITIES], HEAD + numbers[VELOCITIES] + numbers[TALLIES]):
            change[numbers[k]] = 0.0
        if not factor_stage(plan, a, jacobian, scales, store):
            break
        if not solve_stage(plan, a, jacobian, scales, store, change):
            break
        for k in range(n):
            y1[k] += change[k]
            if updates == 0:
                base[k] += tangent[k] - rest[k]
        follow(plan, a, base, y1)
        at_rest(y1, y0, numbers)
        foresee(rest, y1, floats)
        for k in range(n):
            change[k] = y1[k] - rest[k]
            rest[k] = y1[k]
        size = largest(change, y0, y1, settings)
        updates += 1
        if not size < math.inf:
            break
        if updates == 1:
            first = size
            for k in range(n):
                tangent[k] = y1[k]
        elif size > COARSE:
            for k in range(n):
                change[k] = y1[k] - tangent[k]
            if size > CONVERGES * before or largest(change, y0, y1, settings) > BENDS * first:
                break
        stalls = stalls + 1 if updates > 1 and size <= ROUNDING and size > CONVERGES * before else 0
        if size <= 1.0 or stalls == STALLS:
            reached = True
            break
        before = size
    if not reached:
        settings[CAUSE] = ASTRAY
        work[0] = 0.5 * h
        return math.inf
    if unstable(functions, end, y1, jacobian, store, settings, plan, floats, ints):
        settings[ENDED] = settings[CAUSE] = UNSTABLE
        work[0] = 0.5 * h
        return math.inf
    settings[CRAWLED] = settings[CRAWLED] + 1.0 if h <= SHORT * end else 0.0
    if settings[CRAWLED] > MOST_SHORT:
        settings[ENDED] = settings[CAUSE]
        work[0] = 0.0
        return math.inf
    settings[ENDED] = REACHED
    work[0] = h * (2.0 if updates <= EASY else 1.0)
    return 0.0
