# mypy: ignore-errors
"""What fluids of several densities weigh."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM
from sceneql.words.forces.gravity_kernels import acceleration

GIVEN, VECTOR_AT, STRENGTH_AT, WEIGHT_AT = range(4)


@lean(TERM, inner=True)
def weigh(t, y, rate, floats, ints):
    """Adds g to the acceleration by weight."""
    gx, gy, gz = acceleration(floats, ints[GIVEN], ints[VECTOR_AT], ints[STRENGTH_AT])
    floats[ints[WEIGHT_AT]] += gx
    floats[ints[WEIGHT_AT] + 1] += gy
    floats[ints[WEIGHT_AT] + 2] += gz
