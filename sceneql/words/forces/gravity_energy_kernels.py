# mypy: ignore-errors
"""The potential energy of masses in uniform gravity."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import ENERGY
from sceneql.words.forces.gravity_kernels import (
    COUNT,
    GIVEN,
    INVERSE_AT,
    MASS_AT,
    POSITION_AT,
    STRENGTH_AT,
    VECTOR_AT,
    acceleration,
)


@lean(ENERGY, inner=True)
def energy(t, y, floats, ints):
    """Minus the sum of m g . x [J] of the masses that move."""
    gx, gy, gz = acceleration(floats, ints[GIVEN], ints[VECTOR_AT], ints[STRENGTH_AT])
    total = 0.0
    for k in range(ints[COUNT]):
        if floats[ints[INVERSE_AT] + k] > 0.0:
            at = ints[POSITION_AT] + 3 * k
            total -= floats[ints[MASS_AT] + k] * (gx * y[at] + gy * y[at + 1] + gz * y[at + 2])
    return total
