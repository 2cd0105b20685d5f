# mypy: ignore-errors
"""Compiled functions handed over as addresses.

numba can take functions as arguments, but asks Python for the addresses of each at every call: 0.3 ms for the six of a
march. Here the addresses are looked up once and cross as integers.
"""

from typing import Any

import numba
import numpy as np

from sceneql.kernels import address, function_at
from sceneql.system_kernels import (
    DENSE_FUNCTION,
    GAP_FUNCTION,
    IMPACT_FUNCTION,
    RATE_FUNCTION,
    SETTLE_FUNCTION,
    STEP_FUNCTION,
)

KINDS = (STEP_FUNCTION, DENSE_FUNCTION, RATE_FUNCTION, GAP_FUNCTION, IMPACT_FUNCTION, SETTLE_FUNCTION)


def addresses(*functions: Any) -> Any:
    """(6,) int64 addresses of a step, dense output, rate, gap, impact and settle. Keep the functions alive."""
    if numba.config.DISABLE_JIT:
        return functions
    return np.array([address(f, kind) for f, kind in zip(functions, KINDS, strict=True)], dtype=np.int64)


step_at, dense_at, rate_at, gap_at, impact_at, settle_at = (function_at(kind) for kind in KINDS)
