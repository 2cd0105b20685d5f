# mypy: ignore-errors
"""The numba types of the system contract (system/__init__.py says what each function does)."""

from numba import types

F = types.float64
N = types.int64
A = types.float64[::1]
I = types.int64[::1]

TERM = types.void(F, A, A, A, I)
GAP = types.void(F, A, A, A, I)
IMPACT = types.void(F, A, N, A, I)
BACK_OFF = types.void(F, F, A, A, A, A, I)
AFTER_STEP = types.boolean(F, F, A, A, A, A, I)
FREE_MOTION = types.void(F, A, A, I)
TIED_DRIFT = types.void(I, F, A, A, A, A, I)
TIED_DRIFT_OF = types.void(I, F, A, A, A, A, I, I)
"""One part of it, with its own integers last."""

ENERGY = F(F, A, A, I)
LIMIT = F(F, A, A, A, I)

RATE_FUNCTION = types.FunctionType(TERM)
GAP_FUNCTION = types.FunctionType(GAP)
IMPACT_FUNCTION = types.FunctionType(IMPACT)
BACK_OFF_FUNCTION = types.FunctionType(BACK_OFF)
AFTER_STEP_FUNCTION = types.FunctionType(AFTER_STEP)
FREE_MOTION_FUNCTION = types.FunctionType(FREE_MOTION)
TIED_DRIFT_FUNCTION = types.FunctionType(TIED_DRIFT)

JACOBIAN = types.void(I, F, A, A, A, I)
STEP = types.float64(I, F, F, A, A, A, A, A, I, A, I)
DENSE = types.void(F, F, A, A, A, A, A, A, I, A)

ENERGY_FUNCTION = types.FunctionType(ENERGY)
LIMIT_FUNCTION = types.FunctionType(LIMIT)

EVENT = types.Tuple((N, F))(I, F, F, A, A, A, A, A, A, A, I, A, I, A, I, F)
"""events_kernels.find_event."""

JACOBIAN_FUNCTION = types.FunctionType(JACOBIAN)
STEP_FUNCTION = types.FunctionType(STEP)
DENSE_FUNCTION = types.FunctionType(DENSE)
EVENT_FUNCTION = types.FunctionType(EVENT)
