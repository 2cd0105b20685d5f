# mypy: ignore-errors
"""Skeletons' densities and their gradients at a point, compiled only when a tape has such parts."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.field.skeleton.skeleton_kernels import skeleton_gradient, skeleton_value

F = types.float64
AT = (F[:, ::1], types.int64, types.int64, F, F, F)


@lean(F(*AT), inner=True)
def value(parts, start, stop, x, y, z):
    """The density at a point."""
    return skeleton_value(parts, start, stop, x, y, z)


@lean(types.UniTuple(F, 3)(*AT), inner=True)
def gradient(parts, start, stop, x, y, z):
    """The gradient of the density at a point."""
    return skeleton_gradient(parts, start, stop, x, y, z)
