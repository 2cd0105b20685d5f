# mypy: ignore-errors
"""The force of a uniform magnetic field."""

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM


@kernel(TERM, inner=True)
def magnetic(t, y, rate, floats, ints):
    """Adds q v x B. ints: velocity_at, count, charge_at, charge_step, field_at."""
    velocity_at, count, charge_at, step = ints[0], ints[1], ints[2], ints[3]
    bx, by, bz = floats[ints[4]], floats[ints[4] + 1], floats[ints[4] + 2]
    for k in range(count):
        q = floats[charge_at + k * step]
        at = velocity_at + 3 * k
        vx, vy, vz = y[at], y[at + 1], y[at + 2]
        rate[at] += q * (vy * bz - vz * by)
        rate[at + 1] += q * (vz * bx - vx * bz)
        rate[at + 2] += q * (vx * by - vy * bx)
