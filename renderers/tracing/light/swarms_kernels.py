# mypy: ignore-errors
"""Light of spheres that glow: samples tell of near ones, and swarms of small ones are summed up.

Of one that covers less than a sample's share of the sky few samples around tell, with too much of its light, and other
ones in the next frame: a floor under sparks would boil. Swarms throw no shadows.
"""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.light.light_kernels import smoothstep
from renderers.tracing.light.sampling_kernels import SKY_COUNT
from renderers.tracing.scene_kernels import part

FEWEST, ENOUGH = 1.0, 8.0
"""Samples of a whole net that meet a sphere up to which they are not counted, and from which on they are all."""


@part
def told(scene, item, t):
    """Share of what a sample that meets an item at distance t tells: 1 but for small spheres that glow."""
    at = layout.ITEMS + 4 * item
    if scene.ints[layout.SWARM_COUNT] == 0 or scene.ints[at + layout.KIND] != layout.ROUND:
        return 1.0
    u = scene.reals
    k, s = scene.ints[at + layout.REALS_AT], scene.ints[at + layout.SURFACE_AT] + layout.EMISSION
    if u[k + 3] != 0.0 or u[k + 4] != 0.0 or u[k + 5] != 0.0 or max(u[s], max(u[s + 1], u[s + 2])) <= 0.0:
        return 1.0
    part_of_sky = u[k + 6] / (t + u[k + 6])
    return smoothstep(FEWEST, ENOUGH, SKY_COUNT * part_of_sky * part_of_sky)


@part
def swarm_light(scene, x, y, z, nx, ny, nz):
    """Irradiance (3) of all swarms on a surface."""
    u = scene.reals
    r, g, b = 0.0, 0.0, 0.0
    k = scene.ints[layout.SWARMS_AT]
    for _ in range(scene.ints[layout.SWARM_COUNT]):
        dx, dy, dz = u[k] - x, u[k + 1] - y, u[k + 2] - z
        height = dx * nx + dy * ny + dz * nz
        if height > 0.0:
            d2 = dx * dx + dy * dy + dz * dz + u[k + 3]
            share = height / (d2 * np.sqrt(d2))
            r, g, b = r + share * u[k + 4], g + share * u[k + 5], b + share * u[k + 6]
        k += layout.SWARM
    return r, g, b
