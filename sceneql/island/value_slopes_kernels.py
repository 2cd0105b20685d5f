# mypy: ignore-errors
"""The derivatives of terms by the state through the values that they read: the chain rule, with differences of terms.

Integers of `by_values`: how many values, terms, rows and columns there are, and where their tables start, all relative
to the first of them. The program that evaluates the derivatives of the values stands from END up to the first table.
A value: its float, its first reading and the last one's end. A reading: a column's number, and the float of the value's
derivative by it. A term: the number by which its kernel is found, and where its integers start and end. A row: an entry
of the rate. A column: an entry of y.
"""

import math

import numpy as np

from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.island.inputs_kernels import refresh
from sceneql.system.signatures_kernels import TERM

VALUES, TERMS, ROWS, COLUMNS, VALUES_AT, READINGS_AT, TERMS_AT, ROWS_AT, COLUMNS_AT, END = range(10)

STEP = 1e-7
"""Of differences, in parts of the value, or of what such parts of the entries that it reads make of it: short, for a
value may be large beside what a term does with it, as a place far from 0 is."""
LEAST = 1e-2
"""Part of the largest entry read that counts as the size of those that are smaller."""
SETTLED = 0.4
"""Part by which differences over one and two steps may be apart: beyond there is no slope, as of what pulls a mass to
its own place, or at a jump."""

term_at = kernel_at(TERM)


@lean(TERM, inner=True)
def act(t, y, rate, floats, ints):
    """The rate of the terms alone."""
    for k in range(rate.size):
        rate[k] = 0.0
    for k in range(ints[TERMS_AT], ints[TERMS_AT] + 3 * ints[TERMS], 3):
        term = term_at(ints[k])
        term(t, y, rate, floats, ints[ints[k + 1] : ints[k + 2]])


@lean_inlined
def step_of(value, first, end, y, floats, ints):
    """How far to move a value for differences; 0 where nothing that it reads moves it, or its slope is not finite."""
    columns_at = ints[COLUMNS_AT]
    largest, moved = 0.0, 0.0
    for c in range(ints[COLUMNS]):
        largest = max(largest, abs(y[ints[columns_at + c]]))
    for k in range(first, end, 2):
        size = max(abs(y[ints[columns_at + ints[k]]]), LEAST * largest) if largest > 0.0 else 1.0
        moved += abs(floats[ints[k + 1]]) * size
    return STEP * max(abs(value), moved) if 0.0 < moved < math.inf else 0.0


@kernel(TERM, inner=True)
def by_values(t, y, entries, floats, ints):
    """Entry c rows + r: what the terms add to the derivative of rate[row r] by y[column c] through their values.

    A term's derivative by a value is a difference of fourth order; the value's own by what it reads is exact.
    """
    refresh(t, y, floats, ints[END : ints[VALUES_AT]])
    rows = ints[ROWS]
    rate, near, far = np.zeros(y.size), np.zeros(rows), np.zeros(rows)
    for v in range(ints[VALUES_AT], ints[VALUES_AT] + 3 * ints[VALUES], 3):
        at, first, end = ints[v], ints[v + 1], ints[v + 2]
        value = floats[at]
        step = step_of(value, first, end, y, floats, ints)
        if step == 0.0:
            continue
        step = (value + step) - value
        for side in (1.0, -1.0):
            floats[at] = value + side * step
            act(t, y, rate, floats, ints)
            for r in range(rows):
                near[r] = 0.5 * side * rate[ints[ints[ROWS_AT] + r]] + (near[r] if side < 0.0 else 0.0)
            floats[at] = value + 2.0 * side * step
            act(t, y, rate, floats, ints)
            for r in range(rows):
                far[r] = 0.25 * side * rate[ints[ints[ROWS_AT] + r]] + (far[r] if side < 0.0 else 0.0)
        floats[at] = value
        for r in range(rows):
            if abs(near[r] - far[r]) > SETTLED * max(abs(near[r]), abs(far[r])):
                continue
            slope = (4.0 * near[r] - far[r]) / (3.0 * step)
            for k in range(first, end, 2):
                entries[ints[k] * rows + r] += slope * floats[ints[k + 1]]
    act(t, y, rate, floats, ints)  # what terms leave in the floats is that of the values again
