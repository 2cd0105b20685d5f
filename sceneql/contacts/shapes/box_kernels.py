# mypy: ignore-errors
"""The rectangular block; size: its half sides (3)."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import BEND_TYPE, CLEAR_TYPE, SURFACE_TYPE, inward, turn, unturn


@lean_inlined
def beyond(x, half):
    """Signed distance [m] of a coordinate beyond the nearer side; 0 between the sides."""
    return math.copysign(max(abs(x) - half, 0.0), x)


@lean(SURFACE_TYPE, inner=True)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal; inside, those of the nearest side."""
    size = ints[at + layout.SIZE]
    x, y, z = inward(floats, ints, at, x, y, z)
    ox, oy, oz = abs(x) - floats[size], abs(y) - floats[size + 1], abs(z) - floats[size + 2]
    d = max(ox, max(oy, oz))
    if d <= 0.0:
        a = math.copysign(1.0, x) if d == ox else 0.0
        b = math.copysign(1.0, y) if a == 0.0 and d == oy else 0.0
        c = math.copysign(1.0, z) if a == 0.0 and b == 0.0 else 0.0
    else:
        a, b, c = beyond(x, floats[size]), beyond(y, floats[size + 1]), beyond(z, floats[size + 2])
        d = math.sqrt(a * a + b * b + c * c)
        a, b, c = a / d, b / d, c / d
    a, b, c = turn(floats, ints[at + layout.ROTATION], a, b, c)
    return d, a, b, c


@lean(BEND_TYPE, inner=True)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """(v^2 - (v.n)^2) / rho over the axes past the sides, rho the distance: around edges and corners alone."""
    size = ints[at + layout.SIZE]
    x, y, z = inward(floats, ints, at, x, y, z)
    vx, vy, vz = unturn(floats, ints[at + layout.ROTATION], vx, vy, vz)
    x, y, z = beyond(x, floats[size]), beyond(y, floats[size + 1]), beyond(z, floats[size + 2])
    vx, vy, vz = vx * (x != 0.0), vy * (y != 0.0), vz * (z != 0.0)
    rho = math.sqrt(x * x + y * y + z * z)
    if rho < 1e-12:
        return 0.0
    along = (vx * x + vy * y + vz * z) / rho
    return max(0.0, vx * vx + vy * vy + vz * vz - along * along) / rho


@lean(CLEAR_TYPE, inner=True)
def clear(floats, ints, at, x, y, z, radius):
    """By the distance."""
    size = ints[at + layout.SIZE]
    x, y, z = inward(floats, ints, at, x, y, z)
    x, y, z = beyond(x, floats[size]), beyond(y, floats[size + 1]), beyond(z, floats[size + 2])
    return x * x + y * y + z * z > radius * radius
