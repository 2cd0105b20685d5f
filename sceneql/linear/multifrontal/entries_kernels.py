# mypy: ignore-errors
"""What the factorizations of symmetric and of general matrices share: entries put into fronts, signatures."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.linear.multifrontal import layout
from sceneql.system.signatures_kernels import A, I, N

FACTOR_GENERAL = types.boolean(I, A, A, A)
SOLVE_GENERAL = types.void(I, A, A, A)
FACTOR_SINGLE = types.boolean(I, A, A, A)
SOLVE_SINGLE = types.boolean(I, A, A, A, A)
factor_single_at, solve_single_at = kernel_at(FACTOR_SINGLE), kernel_at(SOLVE_SINGLE)

PASS = types.void(I, A, A, A, N, N)


@lean_inlined
def at_front(plan, s):
    """Where the numbers that are carried to a front start: behind each front's there is room for lanes beyond it."""
    return plan[layout.HEAD + layout.FIELDS * s + 3] + layout.PAD * s


@lean_inlined
def put(plan, values, scale, front, height, begin, end):
    """Add blocks of the matrix, times ``scale``, at their places in a front."""
    unit = plan[layout.UNIT]
    for e in range(begin, end, 2):
        k, place = plan[e], plan[e + 1]
        for _ in range(unit):
            for j in range(unit):
                front[place + j] += scale * values[k + j]
            k += unit
            place += height
