# mypy: ignore-errors
"""Compiled functions passed as addresses.

numba can take functions as arguments, but asks Python for the addresses of each at every call: 0.3 ms for the six of a
march. Here the addresses are looked up once and passed as integers.
"""

from typing import Any

import numpy as np

from sceneql.compiled.kernels import address, function_at
from sceneql.system import signatures_kernels as signatures

KINDS = (
    signatures.STEP_FUNCTION,
    signatures.DENSE_FUNCTION,
    signatures.RATE_FUNCTION,
    signatures.GAP_FUNCTION,
    signatures.IMPACT_FUNCTION,
    signatures.BACK_OFF_FUNCTION,
    signatures.AFTER_STEP_FUNCTION,
    signatures.AFTER_STEP_FUNCTION,
    signatures.FREE_MOTION_FUNCTION,
    signatures.TIED_DRIFT_FUNCTION,
    signatures.JACOBIAN_FUNCTION,
    signatures.EVENT_FUNCTION,
    signatures.ENERGY_FUNCTION,
    signatures.LIMIT_FUNCTION,
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
