# mypy: ignore-errors
"""Bounds of a tape's gradient in a box."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.slope_kernels import differentiate
from sceneql.field.tape.tape_ops import TAPE


@lean(f"UniTuple(float64, 3)({TAPE})")
def steepness(code, constants, parts, scratch):
    """Bounds of |df/dx|, |df/dy|, |df/dz| in the box for which ``box`` left WHOLE in scratch; infinite if unknown."""
    if not differentiate(code, parts, scratch, 8, 0.0, 0.0, 0.0):
        return np.inf, np.inf, np.inf
    last = code.shape[0] - 1
    return (
        max(-scratch[last, 2], scratch[last, 3]),
        max(-scratch[last, 4], scratch[last, 5]),
        max(-scratch[last, 6], scratch[last, 7]),
    )


@inlined
def turning(scratch, last):
    """Sum of the bounds of ``steepness`` along the axes in which f may rise and fall; ``last`` is the tape's last row.

    Along the others f is monotone in the box, least and greatest on the box's faces.
    """
    total = 0.0
    for axis in range(3):
        low, high = scratch[last, 2 + 2 * axis], scratch[last, 3 + 2 * axis]
        if not (low >= 0.0 or high <= 0.0):
            total += max(-low, high)
    return total
