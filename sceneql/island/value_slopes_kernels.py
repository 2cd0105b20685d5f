# mypy: ignore-errors
"""Derivatives of terms with respect to the state through values that they read: chain rule, with differences of terms.

Integers of `by_values`: the numbers of values, terms, rows and columns, and the starts of their tables, relative to the
first integer. From END up to the first table: the program that evaluates the derivatives of the values. A value: its
offset in the floats, start and end of its readings. A reading: the number of a column, and the offset of the value's
derivative with respect to it. A term: its kernel's number, start and end of its integers. A row: an entry of the rate.
A column: an entry of y.
"""

import math

import numpy as np

from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.island.inputs_kernels import refresh
from sceneql.system.signatures_kernels import TERM

VALUES, TERMS, ROWS, COLUMNS, VALUES_AT, READINGS_AT, TERMS_AT, ROWS_AT, COLUMNS_AT, END = range(10)

STEP = 1e-7
"""Relative difference step: of the value, or of its change by such parts of the entries that it reads. Short, for a
value (a place far from 0, say) may be large beside the length on which the term varies."""
LEAST = 1e-2
"""Least size that an entry counts as, as a part of the largest entry read."""
SETTLED = 0.4
"""Relative deviation of differences over one and two steps beyond which there is no slope, as at a jump or for an
attractor at a mass's own place."""

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
    """The difference step of a value; 0 where the value's derivatives are all zero or not finite."""
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
    """Add to entry c rows + r the terms' part of d rate[row r]/d y[column c] through their values: d term/d value by
    fourth-order differences, d value/dy exactly."""
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
    act(t, y, rate, floats, ints)  # leave in the floats what terms write there for the unchanged values
