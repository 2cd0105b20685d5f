# mypy: ignore-errors
"""The force of a uniform electric field."""

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

VELOCITY_AT, COUNT, CHARGE_AT, CHARGE_STEP, FIELD_AT = range(5)


@kernel(TERM, inner=True)
def electric(t, y, rate, floats, ints):
    """Adds q E."""
    velocity_at, count, charge_at, step = ints[VELOCITY_AT], ints[COUNT], ints[CHARGE_AT], ints[CHARGE_STEP]
    ex, ey, ez = floats[ints[FIELD_AT]], floats[ints[FIELD_AT] + 1], floats[ints[FIELD_AT] + 2]
    for k in range(count):
        q = floats[charge_at + k * step]
        at = velocity_at + 3 * k
        rate[at] += q * ex
        rate[at + 1] += q * ey
        rate[at + 2] += q * ez
