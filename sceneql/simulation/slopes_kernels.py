# mypy: ignore-errors
"""An island's Jacobian in compressed sparse rows: put together of the slopes of its terms, or by differences."""

import math

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.pointers_kernels import AT_RATE, rate_at
from sceneql.system_kernels import JACOBIAN

ROUNDING = 2.2e-16


@lean_inlined
def gather(values, floats, ints, at):
    """Add the entries, which stand behind the values, to their places; then multiply rows by inverse masses.

    ints[at:] = (values, entries, place of the table of places, of the starts of rows, of the masses, number of those);
    a triple for the masses of each model: (velocity_at, inverse_at, count).
    """
    count, places = ints[at], ints[at + 2]
    for k in range(ints[at + 1]):
        values[ints[places + k]] += values[count + k]
    starts = ints[at + 3]
    for triple in range(ints[at + 4], ints[at + 4] + 3 * ints[at + 5], 3):
        for k in range(ints[triple + 2]):
            inverse = floats[ints[triple + 1] + k]
            row = starts + ints[triple] + 3 * k
            for place in range(ints[row], ints[row + 3]):
                values[place] *= inverse


@lean(JACOBIAN)
def differences(functions, t, y, values, floats, ints):
    """The full Jacobian by forward differences; moves as in RADAU5 (Hairer & Wanner 1996, IV.8).

    ``values``: (n * n,) row by row, then 3n of scratch.
    """
    rate = rate_at(functions[AT_RATE])
    n = y.size
    moved = values[n * n : n * n + n]
    first = values[n * n + n : n * n + 2 * n]
    other = values[n * n + 2 * n : n * n + 3 * n]
    for k in range(n):
        moved[k] = y[k]
    rate(t, y, first, floats, ints)
    for j in range(n):
        moved[j] = y[j] + math.sqrt(ROUNDING * max(1e-5, abs(y[j])))
        move = moved[j] - y[j]
        rate(t, moved, other, floats, ints)
        moved[j] = y[j]
        for i in range(n):
            values[i * n + j] = (other[i] - first[i]) / move
