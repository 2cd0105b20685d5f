# mypy: ignore-errors
"""How the integers of a plan lie (multifrontal_kernels.py says what they are)."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.system.signatures_kernels import A, I, N

PIECES_AT, PIECES, ENTRY, THREADS, PIECE_AT, UNIT, FORWARD, BACKWARD = range(8, 16)
SINGLE_FACTOR, SINGLE_SOLVE, SINGLE_PIECE, SINGLE_FORWARD, SINGLE_BACKWARD = range(16, 21)
IN_SINGLE, RESTING, EXACT, SCALE, STARTS_AT, COLUMNS_AT, HEAD = range(21, 28)
NEW, TRIED, WEAK = 1, 2, 3
"""IN_SINGLE of factors in single precision: new, found good, or to be refined; 0: they are in double precision."""
FIELDS = 11
PAD = 16
"""Zeros behind the factors of each front: lanes reach that far beyond a row."""

FACTOR_SINGLE = types.boolean(I, A, A, A)
SOLVE_SINGLE = types.boolean(I, A, A, A, A)
factor_single_at, solve_single_at = kernel_at(FACTOR_SINGLE), kernel_at(SOLVE_SINGLE)

ROWS = 4
"""Of the factors, that a pass of a solution reads at a time."""
PASS = types.void(I, A, A, A, N, N)


@lean_inlined
def at_front(plan, s):
    """Where the numbers that are carried to a front start: behind each front's there is room for lanes beyond it."""
    return plan[HEAD + FIELDS * s + 3] + PAD * s
