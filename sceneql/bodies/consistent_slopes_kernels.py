# mypy: ignore-errors
"""The derivatives of the closing term of masses whose inertia is a sparse matrix."""

from sceneql.bodies import consistent_kernels as term
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def close(t, y, entries, floats, ints):
    """dx/dt = v of every entry that is not held: the linear systems have the inertia itself (linear/elimination.py)."""
    for k in range(ints[term.COUNT]):
        if floats[ints[term.HELD_AT] + k] == 0.0:
            entries[k] += 1.0
