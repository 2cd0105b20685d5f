# mypy: ignore-errors
"""Least and largest numbers as kernels find them."""

from sceneql.compiled.kernels import lean
from sceneql.field.enclose.extent_kernels import extent


@lean("UniTuple(float64, 2)(float64[::1])")
def extremes(numbers):
    """(least, largest)."""
    return extent(numbers, numbers.shape[0])
