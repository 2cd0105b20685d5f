# mypy: ignore-errors
"""Camera rays through the points of a picture."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import part

TILE, BLOCK = 16, 4
"""Pixels are ordered in tiles of 16 x 16, and in these in blocks of 4 x 4, so that a packet's rays are neighbors."""


@part
def camera_ray(reals, px, py):
    """(origin, direction, radius, spread) of the ray through (px, py) [pixels]; pixel (0, 0) covers 0..1 x 0..1.

    The ray is the axis of a cone: half a pixel's width is ``radius`` + ``spread`` t at distance t.
    """
    camera = layout.CAMERA
    width, height, half_height = reals[layout.WIDTH], reals[layout.HEIGHT], reals[camera + 12]
    u = (2.0 * px - width) / height * half_height
    v = (1.0 - 2.0 * py / height) * half_height
    pixel = half_height / height
    if reals[camera + 13] != 0.0:
        # From the plane of the origin, which ``window`` has put before all that is drawn.
        return (
            reals[camera] + u * reals[camera + 3] + v * reals[camera + 6],
            reals[camera + 1] + u * reals[camera + 4] + v * reals[camera + 7],
            reals[camera + 2] + u * reals[camera + 5] + v * reals[camera + 8],
            -reals[camera + 9],
            -reals[camera + 10],
            -reals[camera + 11],
            pixel,
            0.0,
        )
    dx = u * reals[camera + 3] + v * reals[camera + 6] - reals[camera + 9]
    dy = u * reals[camera + 4] + v * reals[camera + 7] - reals[camera + 10]
    dz = u * reals[camera + 5] + v * reals[camera + 8] - reals[camera + 11]
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    return (
        reals[camera],
        reals[camera + 1],
        reals[camera + 2],
        dx / length,
        dy / length,
        dz / length,
        0.0,
        pixel / length,
    )


@part
def next_place(k, last, x, y, width):
    """(x, y) of pixel k, where those of pixel ``last`` are known: most follow one another, and a division is slow."""
    if k == last + 1:
        return (x + 1, y) if x + 1 < width else (0, y + 1)
    return k % width, k // width


@part
def place_of(i):
    """(x, y) of the ith pixel of a band TILE rows high, in the order of tiles."""
    left, i = i // (TILE * TILE) * TILE, i % (TILE * TILE)
    g, r = i // TILE, i % TILE
    x, y = g & 1 | (g >> 1) & 2, (g >> 1) & 1 | (g >> 2) & 2
    return left + x * BLOCK + r % BLOCK, y * BLOCK + r // BLOCK
