# mypy: ignore-errors
"""Kernels found by an integer, their address, which may stand among the integers of another kernel.

So a kernel calls functions that only the run knows.
"""

from typing import Any

from numba import types

from sceneql.compiled.kernels import address, function_at


def number_of(function: Any, signature: Any) -> int:
    """The integer by which kernels find another kernel of that signature."""
    return address(function, types.FunctionType(signature))


def kernel_at(signature: Any) -> Any:
    """A function that gives kernels the kernel of a ``number_of``."""
    return function_at(types.FunctionType(signature))
