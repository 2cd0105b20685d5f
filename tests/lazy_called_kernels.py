# mypy: ignore-errors
"""What lazy_calling_kernels calls."""

from numba import types

from sceneql.compiled.kernels import lean

F = types.float64


@lean(types.UniTuple(F, 2)(F, types.int64), inner=True)
def halved(x, parts):
    return x / parts, 0.0
