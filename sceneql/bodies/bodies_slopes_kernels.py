# mypy: ignore-errors
"""The derivatives of the closing term of point masses."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def close(t, y, entries, floats, ints):
    """dx/dt = v of every mass that moves. ints: those of bodies_kernels.close."""
    for k in range(ints[2]):
        if floats[ints[3] + k] > 0.0:
            for c in range(3 * k, 3 * k + 3):
                entries[c] += 1.0
