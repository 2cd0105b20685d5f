# mypy: ignore-errors
"""The closing term of point masses."""

from sceneql.kernels import kernel
from sceneql.system_kernels import TERM


@kernel(TERM)
def close(t, y, rate, floats, ints):
    """Newton's second law: newtons in ``rate`` become accelerations, and dx/dt = v.

    ints: position_at, velocity_at, count, inverse_at. A fixed mass (inverse 0) has rate 0.
    """
    position_at, velocity_at, count, inverse_at = ints[0], ints[1], ints[2], ints[3]
    for k in range(count):
        inverse = floats[inverse_at + k]
        for c in range(3 * k, 3 * k + 3):
            rate[velocity_at + c] *= inverse
            rate[position_at + c] = y[velocity_at + c] if inverse > 0.0 else 0.0
