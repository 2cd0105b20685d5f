# mypy: ignore-errors
"""Light from around through transparent things.

Rays to the sky and to surfaces go on straight through glass, in place of refracted ones: the light that comes through
is right in sum, but not gathered in caustics. It is dimmed by Fresnel's transmission where it enters and by the glass's
color; the rest is what the glass mirrors: the sky, and where that is hidden what is straight ahead in place of what
hides it, so that equal light from all around stays equal and none comes into closed rooms.
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.light_kernels import dielectric, sky_radiance
from renderers.tracing.scene_kernels import SCENE, SCRATCH, part
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.surface_kernels import color_at, normal_at
from sceneql.compiled.kernels import kernel

_f = types.float64
PASSED = 16
"""Most surfaces of glass on the way of a ray; the next one counts as open."""


CLEAR = 0.5
"""Share of the light into a surface that is not scattered in it, above which rays go on through it."""


@part
def clearness(scene, item):
    """Share of the light into an item that is not scattered in it."""
    return scene.reals[scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT] + layout.TRANSMISSION]


@kernel(
    types.Tuple((_f, types.int64, types.UniTuple(_f, 6)))(SCENE, SCRATCH, *(_f,) * 8, types.int64), _nrt=False
)  # fmt: skip
def go_through(scene, scratch, x, y, z, dx, dy, dz, t, radius, item):
    """(t, item, (share of the light from there (3), radiance from the way (3))) of a ray that meets glass at t.

    The item is the first that is no glass, -1 for the sky; where half of the light or more is scattered, that is none.
    """
    u = scene.reals
    wr, wg, wb = 1.0, 1.0, 1.0
    red, green, blue = 0.0, 0.0, 0.0
    for _ in range(PASSED):
        px, py, pz = x + t * dx, y + t * dy, z + t * dz
        nx, ny, nz, fx, fy, fz, lift, _, pr, pg, pb = normal_at(scene, scratch, item, px, py, pz)
        if dx * fx + dy * fy + dz * fz <= 0.0:  # what would be mirrored within the glass leaves it
            cosine = min(max(-dx * nx - dy * ny - dz * nz, 0.0), 1.0)
            s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
            back = dielectric(cosine, 1.0 / u[s + layout.INDEX])
            mx, my, mz = dx + 2.0 * cosine * nx, dy + 2.0 * cosine * ny, dz + 2.0 * cosine * nz
            off = 0.05 * radius + 1e-6 * (abs(px) + abs(py) + abs(pz)) + lift
            sx, sy, sz = px + off * fx, py + off * fy, pz + off * fz
            _, _, free = walk(scene, scratch, sx, sy, sz, mx, my, mz, 0.0, np.inf, True)
            sr, sg, sb = sky_radiance(u, min(max(my, -1.0), 1.0))
            free *= back
            red, green, blue = red + wr * free * sr, green + wg * free * sg, blue + wb * free * sb
            back -= free
            r, g, b = color_at(scene, item, (pr, pg, pb), px, py, pz, nx, ny, nz, dx, dy, dz, radius)
            share = clearness(scene, item) * (1.0 - back - free)
            wr, wg, wb = wr * (share * r + back), wg * (share * g + back), wb * (share * b + back)
        near = t + 1e-6 * (abs(px) + abs(py) + abs(pz)) + lift
        t, item, _ = walk(scene, scratch, x, y, z, dx, dy, dz, near, np.inf, False)
        if item < 0 or clearness(scene, item) <= CLEAR:
            return t, item, (wr, wg, wb, red, green, blue)
    return np.inf, -1, (wr, wg, wb, red, green, blue)
