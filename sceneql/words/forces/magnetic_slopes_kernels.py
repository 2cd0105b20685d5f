# mypy: ignore-errors
"""The derivatives of the force of a uniform magnetic field."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def magnetic(t, y, entries, floats, ints):
    """The matrix of q v x B of each mass, a block of 3x3 by its velocity. ints: those of magnetic_kernels.magnetic."""
    bx, by, bz = floats[ints[4]], floats[ints[4] + 1], floats[ints[4] + 2]
    for k in range(ints[1]):
        q = floats[ints[2] + k * ints[3]]
        entries[9 * k + 1] += q * bz
        entries[9 * k + 2] -= q * by
        entries[9 * k + 3] -= q * bz
        entries[9 * k + 5] += q * bx
        entries[9 * k + 6] += q * by
        entries[9 * k + 7] -= q * bx
