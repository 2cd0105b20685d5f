# mypy: ignore-errors
"""A step along a path of rests where a barrier keeps surfaces apart.

Such paths bend wherever surfaces meet, so that a tangent tells little of what comes: each step goes along it as far as
surfaces stay apart, and from there down the potential to a rest, by Newton's method with its search and limit
(linear/newton_search_kernels.py). No step is accepted that goes much farther than the tangent did: it may have leapt to
another branch.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_JACOBIAN, AT_LIMIT, AT_RATE, jacobian_at, limit_at, rate_at
from sceneql.linear.newton_kernels import (
    CAREFUL,
    FACTORED,
    FACTORIZATIONS,
    ITERATIONS,
    follow,
    foresee,
    largest,
    leave,
    newton,
)
from sceneql.linear.stage_kernels import factor_stage, solve_stage
from sceneql.stepping.equilibrium_kernels import (
    ARRAYS,
    ASTRAY,
    CAUSE,
    CRAWLED,
    ENDED,
    HEAD,
    MOST_SHORT,
    PLAN_AT,
    REACHED,
    ROOM,
    SCALES_AT,
    SHORT,
    SIGN,
    TALLIES,
    UNSTABLE,
    VELOCITIES,
    at_rest,
    from_rest,
    lead,
    longest,
    place,
    unstable,
)
from sceneql.system.signatures_kernels import STEP

BENDS = 2.0
"""Part of the way along the tangent by which what follows may change it."""
PASSES = 6
"""Solutions, each from the one before, until nothing moves."""
EASY = 25
"""Updates of a step after which the next one is twice as long."""
ALONG = 0.5
"""Part of the way to where surfaces meet that the next attempt takes."""


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1, the rest at t + h on the path of y0; infinite where it is not found there (equilibrium_kernels.step)."""
    n = y0.size
    base, rest, scratch = work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 7 * n]
    jacobian = work[ARRAYS * n : ARRAYS * n + numbers[ROOM]]
    store = work[ARRAYS * n + numbers[ROOM] :]
    scales, plan = settings[SCALES_AT:], numbers[numbers[PLAN_AT] :]
    rate, slopes, apart = rate_at(functions[AT_RATE]), jacobian_at(functions[AT_JACOBIAN]), functions[AT_LIMIT]
    change, residual, led, own = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n], scratch[3 * n :]
    end, before = t + h, settings[ITERATIONS]
    settings[ENDED] = settings[CAUSE] = ASTRAY
    work[0] = 0.5 * h
    for k in range(n):
        rest[k] = led[k] = y0[k]
    place(rate, end, led, own, plan, floats, ints)
    foresee(rest, rest, floats)
    slopes(functions, end, rest, jacobian, floats, ints)
    if floats[channels.GROWS] != 0.0:
        return math.inf
    if settings[SIGN] == 0.0:
        settings[SIGN] = longest(plan, jacobian, scales, store)
    a = settings[SIGN]
    # Along the tangent, as the first update of equilibrium_kernels.step.
    from_rest(rest, plan, base, y1)
    leave(rate, end, a, base, y1, residual, plan, floats, ints)
    lead(rate, end, a, rest, led, base, y1, residual, own, plan, floats, ints)
    settings[FACTORED] = 0.0
    settings[ITERATIONS] += 1.0
    settings[FACTORIZATIONS] += 1.0
    for k in range(n):
        change[k] = residual[k]
    for k in range(HEAD + numbers[VELOCITIES], HEAD + numbers[VELOCITIES] + numbers[TALLIES]):
        change[numbers[k]] = 0.0
    if not factor_stage(plan, a, jacobian, scales, store) or not solve_stage(plan, a, jacobian, scales, store, change):
        return math.inf
    for k in range(n):
        y1[k] += change[k]
        base[k] += led[k] - rest[k]
    follow(plan, a, base, y1)
    at_rest(y1, y0, numbers)
    for k in range(n):
        change[k] = y1[k] - rest[k]
    first = largest(change, y0, y1, settings)
    if not first < math.inf:
        return math.inf
    part = limit_at(apart)(end, rest, y1, floats, ints)
    if part < 1.0:
        work[0] = h * min(0.5, max(ALONG * part, 0.1))
        return math.inf
    total = 0.0
    for _ in range(PASSES):
        for k in range(n):
            rest[k] = y1[k]
        from_rest(rest, plan, base, y1)
        settings[CAREFUL] = settings[FACTORED] = 0.0
        if not newton(
            functions, end, a, base, rest, y1, scratch, jacobian, store, scales, settings, plan, floats, ints
        ):
            return math.inf
        at_rest(y1, y0, numbers)
        for k in range(n):
            change[k] = y1[k] - rest[k]
        moved = largest(change, y0, y1, settings)
        total += moved
        if not total <= max(1.0, BENDS * first):
            return math.inf
        if moved <= 1.0:
            settings[ENDED] = REACHED
            break
    if settings[ENDED] != REACHED:
        return math.inf
    if unstable(functions, end, y1, jacobian, store, settings, plan, floats, ints):
        settings[ENDED] = settings[CAUSE] = UNSTABLE
        return math.inf
    settings[CRAWLED] = settings[CRAWLED] + 1.0 if h <= SHORT * end else 0.0
    if settings[CRAWLED] > MOST_SHORT:
        settings[ENDED] = settings[CAUSE]
        work[0] = 0.0
        return math.inf
    work[0] = h * (2.0 if settings[ITERATIONS] - before <= EASY else 1.0)
    return 0.0
