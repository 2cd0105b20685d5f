# mypy: ignore-errors
"""Bounds of a tape's gradient in a box."""

import numpy as np

from sceneql.compiled.kernels import lean
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
