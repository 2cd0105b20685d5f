# mypy: ignore-errors
"""One step of the backward differentiation formula of order 2 on steps of any length.

y1 = y0 + w^2/(1 + 2w) (y0 - y_before) + (1 + w)/(1 + 2w) h f(t1, y1), with w = h / (length of the step before). The
first step, and the first after the state was changed from outside (an event), is one of implicit Euler.

``settings``: the memory of Newton's method (newton_kernels), then start and end [s] of the latest step and the length
of the one before it, the part of the latest step's error that Newton's method may leave (0: none), and that error in
units of its tolerance, of the entry that errs most; then the scales of the stage plan. ``numbers``: [1 if steps follow
the error, 1 if there is a step before, entries of the Jacobian's room], then the stage plan. ``work``: the step to try
next, in an array of y's size; the slope at the end; the state before; start and end of the latest step; base; scratch
(4); the Jacobian; the store.
"""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_LIMIT
from sceneql.compiled.vectors_kernels import same
from sceneql.linear.newton_kernels import MEMORY, SHARE, largest, newton, norm
from sceneql.linear.stage_kernels import solve_stage
from sceneql.system.signatures_kernels import STEP

FOLLOWS_ERROR, HAS_BEFORE, ROOM, HEAD = range(4)
START, END, LENGTH, LEFT, ERROR = range(MEMORY, MEMORY + 5)
SCALES_AT = MEMORY + 5
ARRAYS = 10
LONGEST = 2.0
"""Growth of a step: the formula is stable for sequences that grow by less than 1 + sqrt 2 (Grigorieff 1983)."""


@lean_inlined
def remember(t, y0, before, start, end, settings, numbers, settled):
    """Find out whether this step continues the latest (whose start is then the previous state) or repeats it."""
    if t == settings[END] and (settled or same(y0, end)):
        for k in range(y0.size):
            before[k] = start[k]
        settings[LENGTH] = settings[END] - settings[START]
        numbers[HAS_BEFORE] = 1
    elif not (t == settings[START] and same(y0, start)):
        numbers[HAS_BEFORE] = 0
    settings[START] = t
    for k in range(y0.size):
        start[k] = y0[k]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; its error by Milne's device, filtered by the stage system."""
    n = y0.size
    slope, before, start = work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 4 * n]
    end, base, scratch = work[4 * n : 5 * n], work[5 * n : 6 * n], work[6 * n : 10 * n]
    wrong = scratch[:n]
    jacobian = work[ARRAYS * n : ARRAYS * n + numbers[ROOM]]
    store = work[ARRAYS * n + numbers[ROOM] :]
    scales, plan = settings[SCALES_AT:], numbers[HEAD:]
    remember(t, y0, before, start, end, settings, numbers, floats[channels.SETTLED] != 0.0)
    w = h / settings[LENGTH] if numbers[HAS_BEFORE] == 1 else 0.0
    back = w * w / (1.0 + 2.0 * w)
    a = h * (1.0 + w) / (1.0 + 2.0 * w)
    # For the error estimate the guess is the parabola through both states with the slope at the second (Euler's line
    # at the start); without one it is the line, which amplifies residual errors of Newton's method less.
    for k in range(n):
        change = y0[k] - before[k]
        base[k] = y0[k] + back * change
        end[k] = y0[k] + (1.0 + w) * h * rate0[k] - w * w * change
        y1[k] = end[k] if numbers[FOLLOWS_ERROR] == 1 or w == 0.0 else y0[k] + w * change
    settings[END] = t + h
    bounded = functions[AT_LIMIT] != 0 and settings[LEFT] > 0.0
    if bounded:  # errors of a step that is shorter than the one before go with its third power
        settings[SHARE] = max(1.0, settings[LEFT] * settings[ERROR] * min(1.0, w) ** 3)
    if not newton(
        functions, t + h, a, base, y0, y1, scratch, jacobian, store, scales, settings, plan, floats, ints
    ):  # fmt: skip
        work[0] = 0.25 * h
        return math.inf
    # The formula's share of its difference from the guess, both errors by the third (at the start: second) derivative.
    part = (1.0 + w) / (2.0 + 3.0 * w)
    for k in range(n):
        wrong[k] = part * (y1[k] - end[k])
        slope[k] = (y1[k] - base[k]) / a
        end[k] = y1[k]
    if numbers[FOLLOWS_ERROR] == 0 and not bounded:
        return 0.0
    solve_stage(plan, a, jacobian, scales, store, wrong)
    if bounded:
        settings[ERROR] = largest(wrong, y0, y1, settings)
        return 0.0
    error = norm(wrong, y0, y1, settings)
    factor = 0.9 * max(error, 1e-8) ** (-1.0 / (2.0 + numbers[HAS_BEFORE]))
    work[0] = h * min(LONGEST, max(0.2, factor))
    return error
