# mypy: ignore-errors
"""Access to the integers of a plan (layout: multifrontal_kernels.py)."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.linear import multifrontal_layout as layout
from sceneql.system.signatures_kernels import A, I, N

FACTOR_SINGLE = types.boolean(I, A, A, A)
SOLVE_SINGLE = types.boolean(I, A, A, A, A)
factor_single_at, solve_single_at = kernel_at(FACTOR_SINGLE), kernel_at(SOLVE_SINGLE)

PASS = types.void(I, A, A, A, N, N)


@lean_inlined
def at_front(plan, s):
    """Where the numbers that are carried to a front start: behind each front's there is room for lanes beyond it."""
    return plan[layout.HEAD + layout.FIELDS * s + 3] + layout.PAD * s
