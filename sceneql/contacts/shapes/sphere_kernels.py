# mypy: ignore-errors
"""The ball; size: its radius."""

import math

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import BEND_TYPE, CLEAR_TYPE, SURFACE_TYPE


@lean(SURFACE_TYPE, inner=True)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal; upwards at the center."""
    place, radius = ints[at + layout.PLACE], floats[ints[at + layout.SIZE]]
    x, y, z = x - floats[place], y - floats[place + 1], z - floats[place + 2]
    d = math.sqrt(x * x + y * y + z * z)
    if d == 0.0:
        return -radius, 0.0, 1.0, 0.0
    return d - radius, x / d, y / d, z / d


@lean(BEND_TYPE, inner=True)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """(v^2 - (v.n)^2) / rho, rho the distance from the center."""
    place = ints[at + layout.PLACE]
    x, y, z = x - floats[place], y - floats[place + 1], z - floats[place + 2]
    rho = math.sqrt(x * x + y * y + z * z)
    if rho < 1e-12:
        return 0.0
    along = (vx * x + vy * y + vz * z) / rho
    return max(0.0, vx * vx + vy * vy + vz * vz - along * along) / rho


@lean(CLEAR_TYPE, inner=True)
def clear(floats, ints, at, x, y, z, radius):
    """By the distance."""
    place = ints[at + layout.PLACE]
    x, y, z = x - floats[place], y - floats[place + 1], z - floats[place + 2]
    return math.sqrt(x * x + y * y + z * z) - floats[ints[at + layout.SIZE]] > radius
