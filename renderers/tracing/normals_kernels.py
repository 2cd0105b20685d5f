# mypy: ignore-errors
"""Kernels of the pictures of normals and of undecided roots."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import camera_ray
from renderers.tracing.scene_kernels import SCENE, SCRATCH, part
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.surface_kernels import normal_at
from sceneql.compiled.kernels import kernel

UNDECIDED = (1.0, 0.15, 0.0)
"""Color of pixels with an undecided root."""


@part
def seen_normal(scene, scratch, px, py):
    """(whether there is a surface at the picture's point, its unit normal (3) on the viewer's side)."""
    ox, oy, oz, dx, dy, dz, _, _ = camera_ray(scene.reals, px, py)
    t, item, _ = walk(scene, scratch, ox, oy, oz, dx, dy, dz, 0.0, np.inf, False)
    if item < 0:
        return False, 0.0, 0.0, 0.0
    nx, ny, nz, fx, fy, fz, _, _, _, _, _ = normal_at(scene, scratch, item, ox + t * dx, oy + t * dy, oz + t * dz)
    side = 1.0 if dx * fx + dy * fy + dz * fz <= 0.0 else -1.0
    return True, side * nx, side * ny, side * nz


@kernel(types.int64(SCENE, SCRATCH, types.int64, types.int64, types.float32[:, :, ::1]), _nrt=False)
def undecided_rows(scene, scratch, start, stop, picture):
    """Fill rows start..stop of picture (h, w, 3): UNDECIDED where a root is, else gray, black where no surface is.

    Returns the number of pixels with an undecided root.
    """
    counter = scratch.shape[0] - 1
    undecided = 0
    for y in range(start, stop):
        for x in range(int(scene.reals[layout.WIDTH])):
            scratch[counter, 0] = 0.0
            hit, nx, ny, nz = seen_normal(scene, scratch, x + 0.5, y + 0.5)
            c = scene.reals
            facing = abs(nx * c[layout.CAMERA + 9] + ny * c[layout.CAMERA + 10] + nz * c[layout.CAMERA + 11])
            for channel in range(3):
                picture[y, x, channel] = 0.2 + 0.5 * facing if hit else 0.0
            if scratch[counter, 0] > 0.0:
                undecided += 1
                picture[y, x, 0], picture[y, x, 1], picture[y, x, 2] = UNDECIDED
    return undecided


@kernel(
    types.int64(SCENE, SCRATCH, types.int64, types.int64, types.float64[:, ::1], types.float32[:, :, ::1]), _nrt=False
)
def normal_rows(scene, scratch, start, stop, points, picture):
    """Fill rows start..stop of picture (h, w, 3): mean (normal + 1)/2 over ``points``, black without a surface.

    Returns the number of pixels with an undecided root.
    """
    counter = scratch.shape[0] - 1
    undecided = 0
    for y in range(start, stop):
        for x in range(int(scene.reals[layout.WIDTH])):
            scratch[counter, 0] = 0.0
            red, green, blue = 0.0, 0.0, 0.0
            for s in range(len(points)):
                hit, nx, ny, nz = seen_normal(scene, scratch, x + points[s, 0], y + points[s, 1])
                if hit:
                    red, green, blue = red + nx + 1.0, green + ny + 1.0, blue + nz + 1.0
            share = 0.5 / len(points)
            picture[y, x, 0], picture[y, x, 1], picture[y, x, 2] = share * red, share * green, share * blue
            undecided += scratch[counter, 0] > 0.0
    return undecided
