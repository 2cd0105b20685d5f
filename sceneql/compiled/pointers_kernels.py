# mypy: ignore-errors
"""Compiled functions passed as addresses.

numba can take functions as arguments, but asks Python for the addresses of each at every call: 0.3 ms for the six of a
march. Here the addresses are looked up once and passed as integers.
"""

from typing import Any

import numpy as np

from sceneql.compiled.kernels import address, function_at

# Names, not the module: a file that imports from a package has all of the package in the key of its machine code.
from sceneql.system.signatures_kernels import (
    AFTER_STEP_FUNCTION,
    BACK_OFF_FUNCTION,
    DENSE_FUNCTION,
    ENERGY_FUNCTION,
    EVENT_FUNCTION,
    FREE_MOTION_FUNCTION,
    GAP_FUNCTION,
    IMPACT_FUNCTION,
    JACOBIAN_FUNCTION,
    LIMIT_FUNCTION,
    RATE_FUNCTION,
    STEP_FUNCTION,
    TIED_DRIFT_FUNCTION,
)

KINDS = (
    STEP_FUNCTION,
    DENSE_FUNCTION,
    RATE_FUNCTION,
    GAP_FUNCTION,
    IMPACT_FUNCTION,
    BACK_OFF_FUNCTION,
    AFTER_STEP_FUNCTION,
    AFTER_STEP_FUNCTION,
    FREE_MOTION_FUNCTION,
    TIED_DRIFT_FUNCTION,
    JACOBIAN_FUNCTION,
    EVENT_FUNCTION,
    ENERGY_FUNCTION,
    LIMIT_FUNCTION,
)
AT_STEP, AT_DENSE, AT_RATE, AT_GAP, AT_IMPACT, AT_BACK_OFF, AT_AFTER_STEP = range(7)
AT_SETTLE, AT_FREE_MOTION, AT_TIED_DRIFT, AT_JACOBIAN, AT_EVENT, AT_ENERGY, AT_LIMIT = range(7, len(KINDS))
"""Indices into the array of addresses: ``rate = rate_at(functions[AT_RATE])``."""


def addresses(*functions: Any) -> Any:
    """(14,) int64 addresses of KINDS; 0 for None, which must not be called."""
    found = [0 if f is None else address(f, kind) for f, kind in zip(functions, KINDS, strict=True)]
    return np.array(found, dtype=np.int64)


step_at, dense_at, rate_at, gap_at, impact_at, back_off_at, after_step_at = (function_at(kind) for kind in KINDS[:7])
settle_at, free_motion_at, tied_drift_at, jacobian_at, event_at, energy_at, limit_at = (
    function_at(kind) for kind in KINDS[7:]
)
