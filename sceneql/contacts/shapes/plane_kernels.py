# mypy: ignore-errors
"""The half-space below a plane; size: its normal (3), of any length."""

from sceneql.compiled.kernels import lean
from sceneql.contacts.shape_kernels import BEND_TYPE, CLEAR_TYPE, NEAR_TYPE, SURFACE_TYPE, facing


@lean(SURFACE_TYPE, inner=True)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal."""
    return facing(floats, ints, at, x, y, z)


@lean(BEND_TYPE, inner=True)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """0: it is flat."""
    return 0.0


@lean(CLEAR_TYPE, inner=True)
def clear(floats, ints, at, x, y, z, radius):
    """By the distance."""
    return facing(floats, ints, at, x, y, z)[0] > radius


@lean(NEAR_TYPE, inner=True)
def near(floats, ints, at, h, x0, v0, x1, v1, radii, more, found):
    """By the distances of the path's four control points: it does not leave their hull (Bezier)."""
    d, a, b, c = facing(floats, ints, at, 0.0, 0.0, 0.0)
    third = h / 3.0
    for k in range(radii.size):
        start = d + (a * x0[3 * k] + b * x0[3 * k + 1] + c * x0[3 * k + 2])
        end = d + (a * x1[3 * k] + b * x1[3 * k + 1] + c * x1[3 * k + 2])
        leaves = start + third * (a * v0[3 * k] + b * v0[3 * k + 1] + c * v0[3 * k + 2])
        comes = end - third * (a * v1[3 * k] + b * v1[3 * k + 1] + c * v1[3 * k + 2])
        away = min(min(start, end), min(leaves, comes))
        found[k] = 1.0 if away <= radii[k] + more else found[k]
