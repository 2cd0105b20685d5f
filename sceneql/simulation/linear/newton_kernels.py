# mypy: ignore-errors
"""Newton's method for one implicit stage: y = base + a f(t, y), by the linear systems of stage_kernels.

The Jacobian and its factors are kept from stage to stage and step to step as long as the iteration contracts well
(Hairer & Wanner 1996, IV.8). ``memory`` (MEMORY,): the a that is factored (0: none), the contraction of last time;
the relative and absolute tolerance of the norm, and the part of it that the iteration's own error may take.
"""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.linear.stage_kernels import factor_stage, solve_stage
from sceneql.simulation.pointers_kernels import AT_JACOBIAN, AT_RATE, jacobian_at, rate_at
from sceneql.system_kernels import A, F, I

FACTORED, CONTRACTION, RELATIVE, ABSOLUTE, SHARE, MEMORY = range(6)
MOST = 25
"""Iterations of a stage."""
SLOW = 0.2
"""Contraction from which on the Jacobian is evaluated anew."""

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
def fail(change, y):
    """Mark the entry of y that is worst, so that the march rejects the step and a failure names it."""
    worst = 0
    for k in range(y.size):
        if not abs(change[k]) <= abs(change[worst]):
            worst = k
    y[worst] = math.nan


@lean(NEWTON)
def newton(functions, t, a, base, y0, y, change, jacobian, store, scales, memory, plan, floats, ints):
    """Solve for y, which comes as a guess; True if the iteration converged. ``change``: (n,) of scratch.

    ``jacobian`` (room of the pattern) and ``store`` (of the plan) keep values and factors between calls.
    """
    rate, slopes = rate_at(functions[AT_RATE]), jacobian_at(functions[AT_JACOBIAN])
    before = 0.0
    stale = memory[FACTORED] == 0.0
    for iteration in range(MOST):
        rate(t, y, change, floats, ints)
        for k in range(y.size):
            change[k] = base[k] + a * change[k] - y[k]
        if stale:
            slopes(functions, t, y, jacobian, floats, ints)
        if stale or memory[FACTORED] != a:
            memory[FACTORED] = a
            if not factor_stage(plan, a, jacobian, scales, store):
                memory[FACTORED] = 0.0
                fail(change, y)
                return False
        if not solve_stage(plan, a, jacobian, scales, store, change):
            break
        for k in range(y.size):
            y[k] += change[k]
        size = norm(change, y0, y, memory)
        if not size < math.inf:
            break
        contraction = memory[CONTRACTION]
        if iteration > 0:
            contraction = size / before if before > 0.0 else 0.0
            memory[CONTRACTION] = max(contraction, 1e-3)
        if size == 0.0 or (contraction < 1.0 and size * contraction <= memory[SHARE] * (1.0 - contraction)):
            return True
        stale = iteration > 0 and contraction > SLOW
        if stale:
            memory[CONTRACTION] = 1.0
        before = size
    memory[FACTORED] = 0.0
    fail(change, y)
    return False
