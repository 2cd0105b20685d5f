# mypy: ignore-errors
"""The acceleration of a free pair along the normal."""

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.pair_kernels import body_of
from sceneql.contacts.shape_kernels import FOUR, acceleration, bend, surface, velocity
from sceneql.system.signatures_kernels import A, I, N


@lean(FOUR(N, N, A, A, A, I), inner=True)
def pressing(k, j, y, rate, floats, ints):
    """Second derivative of the gap [m/s^2] and the normal (3) there."""
    at = layout.HEAD + layout.OBJECT * j
    to = ints[layout.VELOCITY] + 3 * k
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    ux, uy, uz = velocity(floats, ints, at, px, py, pz)
    ax, ay, az = acceleration(floats, ints, at, px, py, pz)
    _, nx, ny, nz = surface(floats, ints, at, px, py, pz)
    press = (rate[to] - ax) * nx + (rate[to + 1] - ay) * ny + (rate[to + 2] - az) * nz
    return press + bend(floats, ints, at, px, py, pz, vx - ux, vy - uy, vz - uz), nx, ny, nz
