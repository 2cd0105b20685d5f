# mypy: ignore-errors
"""Large symmetric systems by factors in single precision, which take half the time and half the memory.

Solutions are refined by their residuals in double precision until they converge (Wilkinson 1963; Higham, Accuracy and
Stability of Numerical Algorithms, 2002, ch. 12). For a caller whose iteration corrects small errors, only the first
solution with new factors is refined, once, to measure their quality. Solutions with weak factors are all refined once;
poor factors are replaced by ones in double precision (systems_kernels, which also has the layout of plans).
``work``: x and a residual (n,), then scratch in single precision.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.arithmetic_kernels import bits, from_bits
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.backward_kernels import backward_of
from sceneql.linear.multifrontal.entries_kernels import FACTOR_SINGLE, PASS, SOLVE_SINGLE
from sceneql.linear.multifrontal.forward_kernels import forward_of
from sceneql.linear.multifrontal.symmetric_kernels import FACTOR_FRONTS, fronts_of
from sceneql.system.signatures_kernels import A, I

USABLE, GOOD = 0.1, 2e-3
"""Largest relative change in the first refinement: for factors that are usable, and that need no refinement."""
MOST = 12
"""Largest number of refinements of a solution."""
REFINED = 1e-14
"""Relative change of a solution at which its refinement ends."""
STALLED = 0.25
"""Ratio of successive changes from which on they are rounding errors."""
SUBTRACT = types.void(I, A, A, A)


@lean(FACTOR_FRONTS, inner=True)
def factor_fronts(plan, values, factors, work, begin, end):
    """`fronts_of` in single precision."""
    scale = from_bits(plan[layout.SCALE])
    return fronts_of(plan, values, scale, factors.view(np.float32), work.view(np.float32), begin, end)


@lean(PASS, inner=True)
def forward(plan, factors, x, carried, begin, end):
    """The forward substitution of a solution."""
    forward_of(plan, factors.view(np.float32), x.view(np.float32), carried.view(np.float32), begin, end)


@lean(PASS, inner=True)
def backward(plan, factors, x, carried, begin, end):
    """The backward substitution."""
    backward_of(plan, factors.view(np.float32), x.view(np.float32), carried.view(np.float32), begin, end)


@kernel(TILE)
def single_piece(number, t, values, factors, work, plan):
    """Factor the fronts of a piece; its third integer becomes 1 where all pivots were regular."""
    at = plan[layout.PIECES_AT] + 3 * number
    plan[at + 2] = 1 if factor_fronts(plan, values, factors, work, plan[at], plan[at + 1]) else 0


@kernel(TILE)
def single_forward_piece(number, t, factors, x, carried, plan):
    """The forward substitution of a piece."""
    at = plan[layout.PIECES_AT] + 3 * number
    forward(plan, factors, x, carried, plan[at], plan[at + 1])


@kernel(TILE)
def single_backward_piece(number, t, factors, x, carried, plan):
    """The backward substitution of a piece."""
    at = plan[layout.PIECES_AT] + 3 * number
    backward(plan, factors, x, carried, plan[at], plan[at + 1])


@lean_inlined
def solve_roughly(plan, factors, r, room):
    """Replace a right side by its solution; its size, which may exceed single precision's range, is factored out."""
    n, order, fronts, pieces = plan[0], plan[2], plan[1], plan[layout.PIECES]
    half = (n + 1) // 2
    x, carried = room[:half], room[half:]
    size = largest(r, n)
    if size == 0.0:
        return
    own = x.view(np.float32)
    back = size * from_bits(plan[layout.SCALE])
    for k in range(n):
        own[k] = r[plan[order + k]] / size
    entry, threads = plan[layout.ENTRY], plan[layout.THREADS]
    over_threads(entry, threads, plan[layout.SINGLE_FORWARD], pieces, 0.0, factors, x, carried, plan)
    done = 0
    for at in range(plan[layout.PIECES_AT], plan[layout.PIECES_AT] + 3 * pieces, 3):
        forward(plan, factors, x, carried, done, plan[at])
        done = plan[at + 1]
    forward(plan, factors, x, carried, done, fronts)
    last = fronts
    for at in range(plan[layout.PIECES_AT] + 3 * (pieces - 1), plan[layout.PIECES_AT] - 3, -3):
        backward(plan, factors, x, carried, plan[at + 1], last)
        last = plan[at]
    backward(plan, factors, x, carried, 0, last)
    over_threads(entry, threads, plan[layout.SINGLE_BACKWARD], pieces, 0.0, factors, x, carried, plan)
    for k in range(n):
        r[plan[order + k]] = back * own[k]


@lean(SUBTRACT, inner=True)
def subtract_product(plan, values, x, r):
    """r - A x in the place of r."""
    unit, starts, columns = plan[layout.UNIT], plan[layout.STARTS_AT], plan[layout.COLUMNS_AT]
    square = unit * unit
    for row in range(plan[0] // unit):
        if unit == 3:
            u, v, w = r[3 * row], r[3 * row + 1], r[3 * row + 2]
            for place in range(plan[starts + row], plan[starts + row + 1]):
                column, at = 3 * plan[columns + place], 9 * place
                p, q, s = x[column], x[column + 1], x[column + 2]
                u -= values[at] * p + values[at + 1] * q + values[at + 2] * s
                v -= values[at + 3] * p + values[at + 4] * q + values[at + 5] * s
                w -= values[at + 6] * p + values[at + 7] * q + values[at + 8] * s
            r[3 * row], r[3 * row + 1], r[3 * row + 2] = u, v, w
            continue
        for place in range(plan[starts + row], plan[starts + row + 1]):
            column, at = unit * plan[columns + place], square * place
            for i in range(unit):
                total = 0.0
                for j in range(unit):
                    total += values[at + unit * i + j] * x[column + j]
                r[unit * row + i] -= total


@lean_inlined
def largest(x, count):
    """The largest |x[k]|; NaN where one is."""
    most = 0.0
    for k in range(count):
        if not abs(x[k]) <= most:
            most = abs(x[k])
    return most


@lean(FACTOR_SINGLE, inner=True)
def factor_single(plan, values, factors, work):
    """Factor as systems_kernels.factor_system does."""
    most = largest(values, plan[layout.UNIT] ** 2 * plan[plan[layout.STARTS_AT] + plan[0] // plan[layout.UNIT]])
    if not 0.0 < most < math.inf:
        return False
    plan[layout.SCALE] = bits(1.0 / most)
    entry, threads, pieces = plan[layout.ENTRY], plan[layout.THREADS], plan[layout.PIECES]
    over_threads(entry, threads, plan[layout.SINGLE_PIECE], pieces, 0.0, values, factors, work, plan)
    done = 0
    for at in range(plan[layout.PIECES_AT], plan[layout.PIECES_AT] + 3 * plan[layout.PIECES], 3):
        if plan[at + 2] == 0 or not factor_fronts(plan, values, factors, work, done, plan[at]):
            return False
        done = plan[at + 1]
    return factor_fronts(plan, values, factors, work, done, plan[1])


@lean(SOLVE_SINGLE, inner=True)
def solve_single(plan, values, factors, b, work):
    """Solve by the factors of ``factor_single``, x in b's place; False, b unchanged, where the factors are poor."""
    n = plan[0]
    x, r, room = work[:n], work[n : 2 * n], work[2 * n :]
    for k in range(n):
        x[k], r[k] = 0.0, b[k]
    before = math.inf
    for refined in range(MOST):
        solve_roughly(plan, factors, r, room)
        for k in range(n):
            x[k] += r[k]
        change, whole = largest(r, n), largest(x, n)
        if refined == 1 and not change <= USABLE * whole:
            return False
        if refined > 0 and plan[layout.IN_SINGLE] == layout.NEW:
            plan[layout.IN_SINGLE] = layout.TRIED if change <= GOOD * whole else layout.WEAK
        if whole == 0.0 or change <= REFINED * whole or not change < STALLED * before:
            break
        if plan[layout.EXACT] == 0 and (plan[layout.IN_SINGLE] == layout.TRIED or refined > 0):
            break
        before = change
        for k in range(n):
            r[k] = b[k]
        subtract_product(plan, values, x, r)
    for k in range(n):
        b[k] = x[k]
    return largest(x, n) < math.inf
