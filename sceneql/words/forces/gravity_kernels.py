# mypy: ignore-errors
"""The force of uniform gravity."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM, A, N

VELOCITY_AT, COUNT, MASS_AT, GIVEN, VECTOR_AT, STRENGTH_AT, POSITION_AT, INVERSE_AT = range(8)


@lean(types.UniTuple(types.float64, 3)(A, N, N, N))
def acceleration(floats, given, vector_at, strength_at):
    """The vector g [m/s^2]: floats[vector_at:] itself when given, else that direction with the strength."""
    x, y, z = floats[vector_at], floats[vector_at + 1], floats[vector_at + 2]
    if given != 0:
        return x, y, z
    length = math.sqrt(x * x + y * y + z * z)
    scale = floats[strength_at] / length if length > 0.0 else 0.0
    return scale * x, scale * y, scale * z


@lean(TERM, inner=True)
def gravity(t, y, rate, floats, ints):
    """Adds m g."""
    velocity_at, count, mass_at = ints[VELOCITY_AT], ints[COUNT], ints[MASS_AT]
    gx, gy, gz = acceleration(floats, ints[GIVEN], ints[VECTOR_AT], ints[STRENGTH_AT])
    force, mass = rate[velocity_at : velocity_at + 3 * count], floats[mass_at : mass_at + count]
    for k in range(count):
        m = mass[k]
        force[3 * k] += m * gx
        force[3 * k + 1] += m * gy
        force[3 * k + 2] += m * gz
