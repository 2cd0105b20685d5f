# mypy: ignore-errors
"""First hits of the rays through the pixels' centers."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE, camera_ray, place_of
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH
from renderers.tracing.solids.intersect_kernels import ask
from renderers.tracing.solids.surface_kernels import normal_at
from sceneql.compiled.kernels import kernel


@kernel(
    types.void(
        SCENE,
        SCRATCH,
        ASKED,
        types.int64,
        types.int64,
        types.float64[:, ::1],
        types.float64[:, :, ::1],
        types.boolean[:, ::1],
    ),
    _nrt=False,
)
def probe_rows(scene, scratch, asked, start, stop, depth, normals, undecided):
    """Fill rows start..stop, at most TILE, in the mode of ``asked``.

    ``depth`` (h, w) is the distance of the hit [m], infinite for a miss, ``normals`` (h, w, 3) its outward unit normal.
    """
    counter = scratch.shape[0] - 1
    width = int(scene.reals[layout.WIDTH])
    for i in range((width + TILE - 1) // TILE * TILE * TILE):
        x, y = place_of(i)
        y += start
        if x >= width or y >= stop:
            continue
        ox, oy, oz, dx, dy, dz, _, _ = camera_ray(scene.reals, x + 0.5, y + 0.5)
        scratch[counter, 0] = 0.0
        t, item, _ = ask(scene, scratch, asked, ox, oy, oz, dx, dy, dz, np.inf, False)
        if asked[0, layout.MODE] == layout.ASKING:
            continue
        undecided[y, x] = scratch[counter, 0] > 0.0
        depth[y, x] = t
        normals[y, x, 0], normals[y, x, 1], normals[y, x, 2] = 0.0, 0.0, 0.0
        if item >= 0:
            met = normal_at(scene, scratch, item, ox + t * dx, oy + t * dy, oz + t * dz)
            normals[y, x, 0], normals[y, x, 1], normals[y, x, 2] = met[0], met[1], met[2]
