# mypy: ignore-errors
"""Kernels found by an integer, their address, which may stand among the integers of another kernel.

So a kernel calls functions that only the run knows.
"""

from typing import Any

import numba
from numba import types

from sceneql.compiled.kernels import address_of, function_at

_uncompiled: list[Any] = []
"""Functions by their number, in place of addresses where numba is switched off."""


def number_of(function: Any, signature: Any) -> int:
    """The integer by which kernels find another kernel of that signature."""
    if not numba.config.DISABLE_JIT:
        return address_of(function, signature.args)
    _uncompiled.append(function)
    return len(_uncompiled) - 1


def kernel_at(signature: Any) -> Any:
    """A function that gives kernels the kernel of a ``number_of``."""
    return _uncompiled.__getitem__ if numba.config.DISABLE_JIT else function_at(types.FunctionType(signature))
