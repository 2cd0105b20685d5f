# mypy: ignore-errors
"""An island's Jacobian in compressed sparse rows: put together of the slopes of its terms, or by differences."""

import math

from sceneql.kernels import lean
from sceneql.simulation.pointers_kernels import AT_RATE, rate_at
from sceneql.simulation.threads_kernels import TILE, over_threads
from sceneql.system_kernels import JACOBIAN, TERM

ROUNDING = 2.2e-16


@lean(TILE)
def sum_tile(number, t, y, values, floats, ints):
    """The values of a tile as sums of their entries, which stand behind the values; see jacobian.py."""
    at = ints[4]
    count, tiles, starts, parts = ints[at], ints[at + 7], ints[at + 2], ints[at + 6]
    for v in range(count * number // tiles, count * (number + 1) // tiles):
        total = 0.0
        for k in range(parts + ints[starts + v], parts + ints[starts + v + 1]):
            entry = ints[k]
            if entry >= 0:
                total += values[count + entry]
            else:
                total -= values[count - 1 - entry]
        values[v] = total


@lean(TILE)
def scale_tile(number, t, y, values, floats, ints):
    """The rows of a tile of every model's masses multiplied by the inverse masses."""
    at = ints[4]
    tiles, starts = ints[at + 7], ints[at + 3]
    for triple in range(ints[at + 4], ints[at + 4] + 3 * ints[at + 5], 3):
        masses = ints[triple + 2]
        for k in range(masses * number // tiles, masses * (number + 1) // tiles):
            inverse = floats[ints[triple + 1] + k]
            row = starts + ints[triple] + 3 * k
            for place in range(ints[row], ints[row + 3]):
                values[place] *= inverse


@lean(TERM, inner=True)
def gather(t, y, values, floats, ints):
    """Sum the entries to values and multiply their rows by inverse masses: any number of threads, the same bytes."""
    at = ints[4]
    tiles = ints[at + 7]
    if tiles == 1:
        sum_tile(0, t, y, values, floats, ints)
        scale_tile(0, t, y, values, floats, ints)
    else:
        over_threads(ints[at + 8], ints[at + 9], ints[at + 10], tiles, t, y, values, floats, ints)
        over_threads(ints[at + 8], ints[at + 9], ints[at + 11], tiles, t, y, values, floats, ints)


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
