# mypy: ignore-errors
"""The force of a uniform magnetic field."""

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM

VELOCITY_AT, COUNT, CHARGE_AT, CHARGE_STEP, FIELD_AT = range(5)


@kernel(TERM, inner=True)
def magnetic(t, y, rate, floats, ints):
    """Adds q v x B."""
    velocity_at, count, charge_at, step = ints[VELOCITY_AT], ints[COUNT], ints[CHARGE_AT], ints[CHARGE_STEP]
    bx, by, bz = floats[ints[FIELD_AT]], floats[ints[FIELD_AT] + 1], floats[ints[FIELD_AT] + 2]
    for k in range(count):
        q = floats[charge_at + k * step]
        at = velocity_at + 3 * k
        vx, vy, vz = y[at], y[at + 1], y[at + 2]
        rate[at] += q * (vy * bz - vz * by)
        rate[at + 1] += q * (vz * bx - vx * bz)
        rate[at + 2] += q * (vx * by - vy * bx)
