# mypy: ignore-errors
"""A kernel that may call one that is compiled lazily, for test_compiling."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import lazy

F = types.float64
MISTAKEN = types.UniTuple(F, 2)(F, F)
mistaken = lazy("lanes_of_numbers_kernels:doubles", MISTAKEN)
halved = lazy("lazy_called_kernels:halved", types.UniTuple(F, 2)(F, types.int64))


@lean(F(F))
def half_of_positive(x):
    if x <= 0.0:
        return 0.0
    half, rest = halved(x, 2)
    return half + rest


@lean(F(F))
def twice_by_mistake(x):
    if x <= 0.0:
        return 0.0
    once, again = mistaken(x, x)
    return once + again
