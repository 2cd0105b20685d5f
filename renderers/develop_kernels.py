# mypy: ignore-errors
"""The development of pixels, compiled; see develop.py for the tone curve."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, kernel

SHOULDER = 0.6
"""Where the tone curve leaves the straight line."""
WHITENING = 0.15
"""How fast colors brighter than white lose their hue."""


@inlined
def toned(r, g, b):
    """A color of any brightness, mapped to 0..1."""
    peak = max(r, max(g, b))
    if peak <= SHOULDER:
        return r, g, b
    top = SHOULDER + (1.0 - SHOULDER) * np.tanh((peak - SHOULDER) / (1.0 - SHOULDER))
    share = top / peak
    if peak <= 1.0:
        return r * share, g * share, b * share
    white = 1.0 - np.exp(-WHITENING * (peak - 1.0))
    return (
        r * share + white * (top - r * share),
        g * share + white * (top - g * share),
        b * share + white * (top - b * share),
    )


STEPS = 4096
_x = np.linspace(0.0, 1.0, STEPS + 1)
SRGB = np.append(np.where(_x <= 0.0031308, 12.92 * _x, 1.055 * _x ** (1.0 / 2.4) - 0.055), 1.0)
"""The sRGB transfer curve (IEC 61966-2-1) in STEPS pieces, off by less than 0.01 of an 8-bit level between them."""


@inlined
def encoded(x):
    """The sRGB transfer curve of a value in 0..1."""
    place = x * STEPS
    k = int(place)
    return SRGB[k] + (place - k) * (SRGB[k + 1] - SRGB[k])


def _rank(x, y):
    """The bits of x ^ y and y interleaved, lowest first."""
    rank = 0
    for bit in range(3):
        rank = 4 * rank + 2 * (((x ^ y) >> bit) & 1) + ((y >> bit) & 1)
    return rank


THRESHOLDS = np.array([[(_rank(x, y) + 0.5) / 64.0 for x in range(8)] for y in range(8)])
"""Bayer's 8 x 8 dither thresholds, by y and x, in (0, 1)."""


@inlined
def threshold(x, y):
    """The threshold of a pixel."""
    return THRESHOLDS[y & 7, x & 7]


@inlined
def known(x):
    """x, with NaN and negative numbers replaced by 0."""
    return min(x, 65504.0) if x > 0.0 else 0.0


@kernel(
    types.void(types.float32[:, :, ::1], types.float64, types.uint8[:, :, ::1], types.int64, types.int64), _nrt=False
)
def develop_rows(linear, gain, pixels, start, stop):
    """Fill rows start..stop of pixels (h, w, 3). Most pixels have the color of the one before, which is kept."""
    x0 = x1 = x2 = np.float32(np.nan)
    r = g = b = 0.0
    for y in range(start, stop):
        for x in range(linear.shape[1]):
            if linear[y, x, 0] != x0 or linear[y, x, 1] != x1 or linear[y, x, 2] != x2:
                x0, x1, x2 = linear[y, x, 0], linear[y, x, 1], linear[y, x, 2]
                r, g, b = toned(gain * known(x0), gain * known(x1), gain * known(x2))
                r, g, b = 255.0 * encoded(r), 255.0 * encoded(g), 255.0 * encoded(b)
            dither = threshold(x, y)
            pixels[y, x, 0] = int(min(r + dither, 255.0))
            pixels[y, x, 1] = int(min(g + dither, 255.0))
            pixels[y, x, 2] = int(min(b + dither, 255.0))
