"""Cell lists: a hash table in which the 27 cells around any cell have distinct entries."""

from __future__ import annotations

from itertools import product

LEAST = 256


def table(count: int) -> tuple[int, int, int]:
    """Size M (a power of two) and factors P, Q of the hash (i + P j + Q k) mod M of cell (i, j, k).

    M is at least twice ``count``. Cells at most two apart along each axis never share an entry, so no pair of neighbors
    is counted twice.
    """
    size = LEAST
    while size < 2 * count:
        size *= 2
    steps = [step for step in product(range(-2, 3), repeat=3) if any(step)]
    first = int(0.6180339887 * size) | 1
    second = int(0.7548776662 * size) | 1
    while any((i + j * first + k * second) % size == 0 for i, j, k in steps):
        second = (second + 2) % size
    return size, first, second
