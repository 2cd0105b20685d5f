# mypy: ignore-errors
"""The derivatives of the force of a uniform magnetic field."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces import magnetic_kernels as force


@lean(TERM, inner=True)
def magnetic(t, y, entries, floats, ints):
    """The matrix of q v x B of each mass, a block of 3x3 by its velocity."""
    at = ints[force.FIELD_AT]
    bx, by, bz = floats[at], floats[at + 1], floats[at + 2]
    for k in range(ints[force.COUNT]):
        q = floats[ints[force.CHARGE_AT] + k * ints[force.CHARGE_STEP]]
        entries[9 * k + 1] += q * bz
        entries[9 * k + 2] -= q * by
        entries[9 * k + 3] -= q * bz
        entries[9 * k + 5] += q * bx
        entries[9 * k + 6] += q * by
        entries[9 * k + 7] -= q * bx
