# mypy: ignore-errors
"""Least and largest numbers as kernels find them."""

from sceneql.field.extent_kernels import extent
from sceneql.kernels import lean


@lean("UniTuple(float64, 2)(float64[::1])")
def extremes(numbers):
    """(least, largest)."""
    return extent(numbers, numbers.shape[0])
