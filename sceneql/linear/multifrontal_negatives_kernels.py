# mypy: ignore-errors
"""How many eigenvalues of a sparse symmetric matrix are negative (Sylvester's law of inertia)."""

import numpy as np

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear import multifrontal_layout as layout
from sceneql.linear.solver_kernels import NEGATIVES


@lean_inlined
def count(plan, factors):
    """Negative reciprocals of pivots, on the diagonals of the fronts."""
    found = 0
    for s in range(plan[1]):
        t = layout.HEAD + layout.FIELDS * s
        width, height, panel = plan[t + 1], plan[t + 2], plan[t + 5]
        for k in range(width):
            if factors[panel + k * height + k] < 0.0:
                found += 1
    return found


@lean(NEGATIVES)
def negatives(plan, values, factors, work):
    """As many as negative pivots of the factors."""
    if plan[layout.IN_SINGLE] > 0:
        return count(plan, factors.view(np.float32))
    return count(plan, factors)
