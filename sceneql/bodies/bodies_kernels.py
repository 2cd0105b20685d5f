# mypy: ignore-errors
"""The closing term of point masses."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, INVERSE_AT = range(4)


@lean(TERM, inner=True)
def close(t, y, rate, floats, ints):
    """Newton's second law: newtons in ``rate`` become accelerations, and dx/dt = v.

    A fixed mass (inverse 0) has rate 0.
    """
    position_at, velocity_at, count, inverse_at = ints[POSITION_AT], ints[VELOCITY_AT], ints[COUNT], ints[INVERSE_AT]
    # Slices, since the compiler vectorizes loops whose indices are known not to be negative.
    change, moves = rate[velocity_at : velocity_at + 3 * count], rate[position_at : position_at + 3 * count]
    velocity, inverse = y[velocity_at : velocity_at + 3 * count], floats[inverse_at : inverse_at + count]
    for k in range(count):
        change[3 * k] *= inverse[k]
        change[3 * k + 1] *= inverse[k]
        change[3 * k + 2] *= inverse[k]
    for k in range(count):
        free = inverse[k] > 0.0
        moves[3 * k] = velocity[3 * k] if free else 0.0
        moves[3 * k + 1] = velocity[3 * k + 1] if free else 0.0
        moves[3 * k + 2] = velocity[3 * k + 2] if free else 0.0
