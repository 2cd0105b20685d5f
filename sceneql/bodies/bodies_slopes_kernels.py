# mypy: ignore-errors
"""The derivatives of the closing term of point masses."""

from sceneql.bodies import bodies_kernels as term
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def close(t, y, entries, floats, ints):
    """dx/dt = v of every mass that moves."""
    for k in range(ints[term.COUNT]):
        if floats[ints[term.INVERSE_AT] + k] > 0.0:
            for c in range(3 * k, 3 * k + 3):
                entries[c] += 1.0
