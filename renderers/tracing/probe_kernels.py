# mypy: ignore-errors
"""What the rays through the pixels' centers meet first."""

import numpy as np
from numba import types

from renderers.tracing.camera_kernels import camera_ray
from renderers.tracing.intersect_kernels import walk
from renderers.tracing.scene_kernels import SCENE, SCRATCH, WIDTH
from renderers.tracing.surface_kernels import normal_at
from sceneql.kernels import kernel


@kernel(
    types.void(
        SCENE,
        SCRATCH,
        types.int64,
        types.int64,
        types.float64[:, ::1],
        types.float64[:, :, ::1],
        types.boolean[:, ::1],
    ),
    _nrt=False,
)
def probe_rows(scene, scratch, start, stop, depth, normals, undecided):
    """Fill rows start..stop: the way to what is met [m] (h, w), infinite without; its outward unit normal (h, w, 3)."""
    counter = scratch.shape[0] - 1
    for y in range(start, stop):
        for x in range(int(scene.reals[WIDTH])):
            ox, oy, oz, dx, dy, dz, _, _ = camera_ray(scene.reals, x + 0.5, y + 0.5)
            scratch[counter, 0] = 0.0
            t, item, _ = walk(scene, scratch, ox, oy, oz, dx, dy, dz, 0.0, np.inf, False)
            undecided[y, x] = scratch[counter, 0] > 0.0
            depth[y, x] = t
            normals[y, x, 0], normals[y, x, 1], normals[y, x, 2] = 0.0, 0.0, 0.0
            if item >= 0:
                met = normal_at(scene, scratch, item, ox + t * dx, oy + t * dy, oz + t * dz)
                normals[y, x, 0], normals[y, x, 1], normals[y, x, 2] = met[0], met[1], met[2]
