# mypy: ignore-errors
"""Lamps and suns as seen from a point."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import part

BARELY = 1e-6
"""Part of its length by which a ray to a lamp ends before its ball, so that a sphere of the same radius is not hit."""
SHOWN = 1e-3
"""Part of a lamp's radius by which a ball that shows it may be larger."""


@part
def light_at(reals, l, x, y, z):
    """(direction, distance, irradiance per channel of a surface facing it) of light l from a point."""
    k = layout.LIGHTS + layout.LIGHT * l
    ir, ig, ib = reals[k + 4], reals[k + 5], reals[k + 6]
    if reals[k] == layout.SUN:
        return reals[k + 1], reals[k + 2], reals[k + 3], np.inf, ir, ig, ib
    dx, dy, dz = reals[k + 1] - x, reals[k + 2] - y, reals[k + 3] - z
    d2 = max(dx * dx + dy * dy + dz * dz, 1e-12)
    d = np.sqrt(d2)
    return dx / d, dy / d, dz / d, d, ir / d2, ig / d2, ib / d2


@part
def reach(far, radius, square):
    """Parameter at which a ray enters a lamp's ball, of squared direction ``square`` and component 1 along ``far``.

    ``far`` is the distance of the ball's center, in the plane of the disk that the ray goes to. Objects in the ball,
    such as a sphere that shows the lamp, throw no shadow in its light.
    """
    inside = max(square * radius * radius - (square - 1.0) * far * far, 0.0)
    return max((1.0 - BARELY) * (far - np.sqrt(inside)) / square, 0.0)


@part
def in_a_lamp(scene, x, y, z):
    """Whether a place is on what shows a lamp: a ball where that stands, as large, whose light counts as the lamp's."""
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        _, _, _, far, _, _, _ = light_at(scene.reals, l, x, y, z)
        if far < (1.0 + SHOWN) * scene.reals[layout.LIGHTS + layout.LIGHT * l + 7]:
            return True
    return False
