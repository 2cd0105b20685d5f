# mypy: ignore-errors
"""The force of a uniform electric field."""

from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import TERM


@kernel(TERM, inner=True)
def electric(t, y, rate, floats, ints):
    """Adds q E. ints: velocity_at, count, charge_at, charge_step, field_at."""
    velocity_at, count, charge_at, step = ints[0], ints[1], ints[2], ints[3]
    ex, ey, ez = floats[ints[4]], floats[ints[4] + 1], floats[ints[4] + 2]
    for k in range(count):
        q = floats[charge_at + k * step]
        at = velocity_at + 3 * k
        rate[at] += q * ex
        rate[at + 1] += q * ey
        rate[at + 2] += q * ez
