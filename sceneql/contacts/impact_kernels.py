# mypy: ignore-errors
"""The change of velocity in an impact, and the tally of impacts."""

import math

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts import layout

MOST_CUTS = 16
"""Most cuts of one step. The contact starts with this count and an END that never comes where no step is cut."""

STILL = 1e-9
"""Speed [m/s] that counts as zero."""


@lean_inlined
def bounce(vx, vy, vz, nx, ny, nz, restitution, friction):
    """The velocity after an impact with velocity v relative to the surface of normal n, approaching (v.n < 0).

    Newton's restitution along n; across it Coulomb friction: the impulse is at most friction times the normal one and
    never reverses the slip.
    """
    vn = vx * nx + vy * ny + vz * nz
    tx, ty, tz = vx - vn * nx, vy - vn * ny, vz - vn * nz
    slip = math.sqrt(tx * tx + ty * ty + tz * tz)
    keep = 1.0
    if slip > 0.0:
        keep = max(0.0, 1.0 + friction * (1.0 + restitution) * vn / slip)
    vn = -restitution * vn
    return keep * tx + vn * nx, keep * ty + vn * ny, keep * tz + vn * nz


@lean_inlined
def count_hit(floats, at, t, speed):
    """Add an impact at time t [s] with this speed of approach [m/s] to the tally."""
    floats[at + layout.HITS] += 1.0
    if math.isnan(floats[at + layout.FIRST_TIME]):
        floats[at + layout.FIRST_TIME] = t
    floats[at + layout.LAST_TIME] = t
    floats[at + layout.LAST_SPEED] = speed
    floats[at + layout.REST_TIME] = math.nan


@lean_inlined
def scale_of(x, y, z):
    """Size of the coordinates [m], at least 1: the scale of rounding errors of distances."""
    return max(1.0, max(abs(x), max(abs(y), abs(z))))
