# mypy: ignore-errors
"""The interior-point method on bounded rows (bounded_rows_kernels): its first point, steps and what is left.

A row's impulse x in [low, high] has a slack velocity a for its lower bound and c for its upper one: s = a - c, with the
products a (x - low) and c (high - x) driven to 0 (Mehrotra 1992).
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.linear.cones import cone_layout_kernels as layout
from sceneql.linear.cones.bounded_rows_kernels import moves, to_rows
from sceneql.linear.cones.cone_layout_kernels import (
    ROW,
    ROW_A,
    ROW_AIM_A,
    ROW_AIM_C,
    ROW_C,
    ROW_DA,
    ROW_DC,
    ROW_DS,
    ROW_DX,
    ROW_GIVEN,
    ROW_H,
    ROW_HEAVY,
    ROW_HIGH,
    ROW_LEFT,
    ROW_LONG,
    ROW_LOW,
    ROW_S,
    ROW_SIZE,
    ROW_X,
)
from sceneql.system.signatures_kernels import A, F, I

STIFF = 1e8
"""Stiffness of proximal steps of ties in the interior-point method, of the effective mass."""


@lean(types.void(A, I, F))
def begin_rows(floats, ints, fastest):
    """The first point of the interior-point method, from the springs' solution: inside the bounds."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if not moves(floats, c):
            continue
        low, high, heavy = floats[c + ROW_LOW], floats[c + ROW_HIGH], floats[c + ROW_HEAVY]
        s = floats[c + ROW_S] + floats[c + ROW_DS]
        fast = max(fastest / floats[c + ROW_LONG], 1e-300)
        x, room = -heavy * s, min(heavy * fast, 0.5 * (high - low))
        if low > -math.inf:
            x = max(x, low + room)
        if high < math.inf:
            x = min(x, high - room)
        floats[c + ROW_X] = x
        for at, width in ((ROW_A, x - low), (ROW_C, high - x)):
            floats[c + at] = min(fast, heavy * fast * fast / width) if width < math.inf else 0.0
        if low > -math.inf:
            floats[c + ROW_A] += max(s, 0.0)
        if high < math.inf:
            floats[c + ROW_C] += max(-s, 0.0)


@lean(types.float64(A, I))
def left_rows(floats, ints):
    """Write what is left of s = a - c; the largest of this and of the gaps of complementarity; NaN where none is."""
    to_rows(floats, ints, layout.AT_V, ROW_S)
    worst = every = 0.0
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if not moves(floats, c):
            continue
        x, size = floats[c + ROW_X], floats[c + ROW_SIZE]
        floats[c + ROW_S] += floats[c + ROW_GIVEN]
        floats[c + ROW_LEFT] = floats[c + ROW_S] - floats[c + ROW_A] + floats[c + ROW_C]
        full, gap = max(floats[c + ROW_HEAVY] * size, abs(x)), 0.0
        if floats[c + ROW_LOW] > -math.inf:
            gap += (x - floats[c + ROW_LOW]) * floats[c + ROW_A]
        if floats[c + ROW_HIGH] < math.inf:
            gap += (floats[c + ROW_HIGH] - x) * floats[c + ROW_C]
        worst = max(worst, max(abs(floats[c + ROW_LEFT]) / size, gap / (full * size)))
        every += floats[c + ROW_LEFT] + gap
    return worst if abs(every) < math.inf else math.nan


@lean(types.UniTuple(F, 2)(A, I))
def scale_rows(floats, ints):
    """Write H and the aims of the predictor; the sum of the complementarity products, and their number."""
    total = count = 0.0
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_H] = floats[c + ROW_AIM_A] = floats[c + ROW_AIM_C] = 0.0
        if not moves(floats, c):
            continue
        x, slope = floats[c + ROW_X], 0.0
        if floats[c + ROW_LOW] > -math.inf:
            slope += floats[c + ROW_A] / (x - floats[c + ROW_LOW])
            total += floats[c + ROW_A] * (x - floats[c + ROW_LOW])
            count += 1.0
            floats[c + ROW_AIM_A] = -floats[c + ROW_A]
        if floats[c + ROW_HIGH] < math.inf:
            slope += floats[c + ROW_C] / (floats[c + ROW_HIGH] - x)
            total += floats[c + ROW_C] * (floats[c + ROW_HIGH] - x)
            count += 1.0
            floats[c + ROW_AIM_C] = -floats[c + ROW_C]
        floats[c + ROW_H] = 1.0 / slope if slope > 0.0 else STIFF * floats[c + ROW_HEAVY]
    return total, count


@lean(types.void(A, I))
def aim_rows(floats, ints):
    """Write DX by the aims and what is left; what DS adds to it comes once that is known (`turn_rows`)."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        floats[c + ROW_DX] = 0.0
        if moves(floats, c):
            aim = floats[c + ROW_AIM_A] - floats[c + ROW_AIM_C] - floats[c + ROW_LEFT]
            floats[c + ROW_DX] = floats[c + ROW_H] * aim


@lean(types.float64(A, I))
def turn_rows(floats, ints):
    """Write DX, DA and DC by DS; the longest step that keeps all inside."""
    longest = math.inf
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if not moves(floats, c):
            continue
        floats[c + ROW_DX] -= floats[c + ROW_H] * floats[c + ROW_DS]
        x, dx = floats[c + ROW_X], floats[c + ROW_DX]
        for at, change, aim, width, way in (
            (ROW_A, ROW_DA, ROW_AIM_A, x - floats[c + ROW_LOW], dx),
            (ROW_C, ROW_DC, ROW_AIM_C, floats[c + ROW_HIGH] - x, -dx),
        ):
            floats[c + change] = 0.0
            if width < math.inf:
                floats[c + change] = floats[c + aim] - floats[c + at] / width * way
                if way < 0.0:
                    longest = min(longest, -width / way)
                if floats[c + change] < 0.0:
                    longest = min(longest, -floats[c + at] / floats[c + change])
    return longest


@lean(types.void(A, I, F))
def center_rows(floats, ints, centered):
    """Aims of the corrector (Mehrotra 1992), from the predictor's changes."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if not moves(floats, c):
            continue
        x, dx = floats[c + ROW_X], floats[c + ROW_DX]
        if floats[c + ROW_LOW] > -math.inf:
            more = (centered - dx * floats[c + ROW_DA]) / (x - floats[c + ROW_LOW])
            floats[c + ROW_AIM_A] = more - floats[c + ROW_A]
        if floats[c + ROW_HIGH] < math.inf:
            more = (centered + dx * floats[c + ROW_DC]) / (floats[c + ROW_HIGH] - x)
            floats[c + ROW_AIM_C] = more - floats[c + ROW_C]


@lean(types.void(A, I, F))
def advance_rows(floats, ints, part):
    """Take a part of the step."""
    for k in range(ints[layout.ROWS]):
        c = ints[layout.ROWS_AT] + ROW * k
        if moves(floats, c):
            floats[c + ROW_X] += part * floats[c + ROW_DX]
            floats[c + ROW_A] += part * floats[c + ROW_DA]
            floats[c + ROW_C] += part * floats[c + ROW_DC]
