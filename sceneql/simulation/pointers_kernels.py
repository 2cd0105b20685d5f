# mypy: ignore-errors
"""Compiled functions handed over as addresses.

numba can take functions as arguments, but asks Python for the addresses of each at every call: 0.3 ms for the six of a
march. Here the addresses are looked up once and cross as integers.
"""

from typing import Any

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from sceneql.system_kernels import (
    DENSE_FUNCTION,
    GAP_FUNCTION,
    IMPACT_FUNCTION,
    RATE_FUNCTION,
    SETTLE_FUNCTION,
    STEP_FUNCTION,
)

KINDS = (STEP_FUNCTION, DENSE_FUNCTION, RATE_FUNCTION, GAP_FUNCTION, IMPACT_FUNCTION, SETTLE_FUNCTION)


def function_at(kind):
    """The compiled function of ``kind`` at an address, as a value that compiled code can call."""

    @intrinsic
    def at(typing, address):
        def code(context, builder, signature, arguments):
            value = cgutils.create_struct_proxy(kind)(context, builder)
            pointer = builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))
            # The address is known to be one, so the code for Python functions is dropped.
            builder.assume(cgutils.is_not_null(builder, pointer))
            value.jit_addr = pointer
            value.c_addr = value.py_addr = context.get_constant_null(types.voidptr)
            return value._getvalue()

        return kind(types.int64), code

    return at


def addresses(*functions: Any) -> Any:
    """(6,) int64 addresses of a step, dense output, rate, gap, impact and settle. Keep the functions alive."""
    if numba.config.DISABLE_JIT:
        return functions
    compiled = [f.overloads[kind.signature.args] for f, kind in zip(functions, KINDS, strict=True)]
    return np.array([c.library.get_pointer_to_function(c.fndesc.llvm_func_name) for c in compiled], dtype=np.int64)


if numba.config.DISABLE_JIT:
    step_at = dense_at = rate_at = gap_at = impact_at = settle_at = lambda function: function
else:
    step_at, dense_at, rate_at, gap_at, impact_at, settle_at = (function_at(kind) for kind in KINDS)
