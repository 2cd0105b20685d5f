# mypy: ignore-errors
"""Minimum and maximum of many numbers, by integer keys made of their bits: integer loops vectorize."""

import numpy as np

from sceneql.compiled.kernels import inlined

SIGN, REST = np.int64(63), np.int64(0x7FFFFFFFFFFFFFFF)


@inlined
def number_of(key):
    """The number of an integer key."""
    return np.int64(key ^ ((key >> SIGN) & REST)).view(np.float64)


@inlined
def extent(row, n):
    """(minimum, maximum) of the first n > 0 numbers; NaN if one is NaN."""
    least, largest = REST, -REST
    for i in range(n):
        bits = np.float64(row[i]).view(np.int64)
        key = bits ^ ((bits >> SIGN) & REST)
        least = key if key < least else least
        largest = key if key > largest else largest
    return number_of(least), number_of(largest)
