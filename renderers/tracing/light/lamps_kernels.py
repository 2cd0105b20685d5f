# mypy: ignore-errors
"""Images of lamps and suns in mirrors: disks of their angular size and radiance."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.light.light_kernels import smoothstep
from renderers.tracing.scene_kernels import part

BLUR = 2.0
"""Least radius of an image [half widths of a ray's cone]: it is two pixels across, so that points are not lost."""
LEAST_SPREAD = 1e-6
"""Least half width of a cone before a sun, as a tangent: the rays of an orthographic camera stay parallel in a flat
mirror, and rounding alone would say whether they meet a sun of angle 0."""


@part
def mirrored_lamps(scene, ox, oy, oz, dx, dy, dz, radius, spread, far):
    """Radiance (3) of all lights on a mirrored ray's cone, ``radius`` + ``spread`` t wide at t, up to its hit at far.

    An image has an edge, which is drawn by several rays a pixel, but near the least size, where it is soft.
    """
    u = scene.reals
    r, g, b = 0.0, 0.0, 0.0
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        k = layout.LIGHTS + layout.LIGHT * l
        cx, cy, cz, t, size = u[k + 1], u[k + 2], u[k + 3], np.inf, u[k + 8]
        along = cx * dx + cy * dy + cz * dz
        blur = max(abs(spread), LEAST_SPREAD)
        if u[k] == layout.POINT:
            cx, cy, cz = cx - ox, cy - oy, cz - oz
            along = t = cx * dx + cy * dy + cz * dz
            blur = abs(radius + spread * t)
        if along <= 0.0 or (t >= far if t < np.inf else far < np.inf):
            continue
        cx, cy, cz = cx - along * dx, cy - along * dy, cz - along * dz
        off = np.sqrt(cx * cx + cy * cy + cz * cz)
        if t == np.inf:
            off /= along
        blur *= BLUR
        soft = max(min(size, 2.0 * blur - size), 0.0)
        size = max(size, blur)
        if off < size + soft:
            share = (1.0 - smoothstep(size - soft, size + soft, off)) / (np.pi * size * size)
            r, g, b = r + share * u[k + 4], g + share * u[k + 5], b + share * u[k + 6]
    return r, g, b
