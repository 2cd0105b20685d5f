# mypy: ignore-errors
"""Pictures to the planes of a film: BT.709 in 4:2:0, each plane dithered, so that soft gradients stay free of bands."""

from numba import types

from renderers.develop_kernels import threshold
from sceneql.compiled.kernels import inlined, kernel

RED, BLUE = 0.2126, 0.0722
"""Shares of luma (ITU-R BT.709-6, 3.2)."""
LUMA, CHROMA = 219.0 / 255.0, 112.0 / 255.0
"""Levels of video range for a level of full range; chroma's for a difference that goes from -255 to 255."""
TRUSTED = 1e-9
"""A sum of shares is that much off at most: whole levels stay what they are."""


@inlined
def other_threshold(x, y):
    """The picture's own dither is in its levels already: this one is turned and shifted, so that they do not meet.

    From tile to tile of 8 x 8 it begins elsewhere: what is left of meetings is another in each, and none in the mean.
    """
    place = threshold(y + 3, 12 - x % 8) + threshold(x >> 3, y >> 3)
    return place - int(place)


@inlined
def level(value, x, y):
    """A level of video range of a plane, dithered."""
    return int(value + other_threshold(x, y) * (1.0 - 2.0 * TRUSTED) + TRUSTED)


@inlined
def luma(pixels, x, y):
    """Luma of full range, 0 to 255."""
    r, g, b = pixels[y, x, 0], pixels[y, x, 1], pixels[y, x, 2]
    return RED * r + (1.0 - RED - BLUE) * g + BLUE * b


@kernel(types.void(types.uint8[:, :, ::1], types.uint8[:, ::1], types.uint8[:, ::1], types.uint8[:, ::1]), _nrt=False)
def planes(pixels, lumas, blues, reds):
    """Fill luma (h, w) and chroma (h/2, w/2) of pixels (h, w, 3), h and w even.

    A chroma sample stands on its left luma sample, between two rows (ITU-T H.264, figure E-1, type 0): it is the mean
    of two rows and of 1, 2, 1 columns.
    """
    height, width = lumas.shape
    for y in range(height):
        for x in range(width):
            lumas[y, x] = level(16.0 + LUMA * luma(pixels, x, y), x, y)
    for v in range(height // 2):
        for u in range(width // 2):
            blue = red = 0.0
            for y in range(2 * v, 2 * v + 2):
                for k in range(-1, 2):
                    x = max(2 * u + k, 0)
                    bright = luma(pixels, x, y)
                    share = 0.125 * (2 - abs(k))
                    blue += share * (pixels[y, x, 2] - bright) / (1.0 - BLUE)
                    red += share * (pixels[y, x, 0] - bright) / (1.0 - RED)
            blues[v, u] = level(128.0 + CHROMA * blue, u, v)
            reds[v, u] = level(128.0 + CHROMA * red, u, v)
