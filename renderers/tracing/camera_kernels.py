# mypy: ignore-errors
"""Rays of a picture's points."""

import numpy as np

from renderers.tracing.scene_kernels import CAMERA, HEIGHT, WIDTH, part

TILE, BLOCK = 16, 4
"""Pixels are taken in tiles of 16 x 16, blocks of 4 x 4 of them together: a packet's rays are neighbors."""


@part
def camera_ray(reals, px, py):
    """(origin, direction, radius, spread) of the ray through (px, py) [pixels]; pixel (0, 0) covers 0..1 x 0..1.

    The ray stands for a cone: half a pixel's width is ``radius`` + ``spread`` t at distance t.
    """
    width, height, half_height = reals[WIDTH], reals[HEIGHT], reals[CAMERA + 12]
    u = (2.0 * px - width) / height * half_height
    v = (1.0 - 2.0 * py / height) * half_height
    pixel = half_height / height
    if reals[CAMERA + 13] != 0.0:
        # The window lies in the plane of the origin; what stands before it is seen as well.
        back = 1e4 * max(1.0, half_height)
        return (
            reals[CAMERA] + u * reals[CAMERA + 3] + v * reals[CAMERA + 6] + back * reals[CAMERA + 9],
            reals[CAMERA + 1] + u * reals[CAMERA + 4] + v * reals[CAMERA + 7] + back * reals[CAMERA + 10],
            reals[CAMERA + 2] + u * reals[CAMERA + 5] + v * reals[CAMERA + 8] + back * reals[CAMERA + 11],
            -reals[CAMERA + 9],
            -reals[CAMERA + 10],
            -reals[CAMERA + 11],
            pixel,
            0.0,
        )
    dx = u * reals[CAMERA + 3] + v * reals[CAMERA + 6] - reals[CAMERA + 9]
    dy = u * reals[CAMERA + 4] + v * reals[CAMERA + 7] - reals[CAMERA + 10]
    dz = u * reals[CAMERA + 5] + v * reals[CAMERA + 8] - reals[CAMERA + 11]
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    return (
        reals[CAMERA],
        reals[CAMERA + 1],
        reals[CAMERA + 2],
        dx / length,
        dy / length,
        dz / length,
        0.0,
        pixel / length,
    )


@part
def place_of(i):
    """(x, y) of pixel i of a band that is TILE rows high."""
    left, i = i // (TILE * TILE) * TILE, i % (TILE * TILE)
    g, r = i // TILE, i % TILE
    x, y = g & 1 | (g >> 1) & 2, (g >> 1) & 1 | (g >> 2) & 2
    return left + x * BLOCK + r % BLOCK, y * BLOCK + r // BLOCK
