# mypy: ignore-errors
"""What the factorizations of symmetric and of general matrices share: entries put into fronts, signatures."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.linear import multifrontal_layout as layout
from sceneql.system.signatures_kernels import A, I

FACTOR_GENERAL = types.boolean(I, A, A, A)
SOLVE_GENERAL = types.void(I, A, A, A)


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
