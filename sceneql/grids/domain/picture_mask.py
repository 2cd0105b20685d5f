"""Pictures as masks and fields: brightness, contours, interpolated values. Imports imageio where a file is read."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats

MOST_PIXELS = 20_000_000
LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Weights of red, green and blue (ITU-R BT.709)."""
LEAST_AREA = 4.0
"""Least area [pixels] of a piece of a mask; smaller ones are noise."""


@lru_cache(maxsize=4)
def brightness(file: str) -> tuple[Floats, Floats]:
    """Brightness as stored (nonlinear), 0 black to 1 white, and opacity, each (height, width), top row first.

    Raises ValueError for a file that is no picture or has too many pixels.
    """
    import imageio.v3 as imageio

    name = Path(file).name
    try:
        shape = imageio.improps(file, plugin="pillow", index=0).shape
        if math.prod(shape[:2]) > MOST_PIXELS:
            raise ValueError(f"{name} has {math.prod(shape[:2])} pixels, more than {MOST_PIXELS}")
        picture = np.asarray(imageio.imread(file, plugin="pillow", index=0))
    except (OSError, SyntaxError) as error:
        raise ValueError(f"{name} is no picture that can be read") from error
    values = picture.astype(np.float64)
    if np.issubdtype(picture.dtype, np.integer):
        values /= np.iinfo(picture.dtype).max
    if values.ndim == 2:
        return values, np.ones_like(values)
    channels = values.shape[2]
    opacity = values[..., -1] if channels in (2, 4) else np.ones(values.shape[:2])
    return (values[..., :3] @ LUMINANCE if channels >= 3 else values[..., 0]), opacity


def contours(file: str, threshold: float, bright: bool) -> dict[str, Floats]:
    """Polygons (k, 2) around the regions brighter (or darker) than the threshold, in pixels from the low left corner.

    Transparent pixels are outside. The largest polygon is named `shore`, then `island1`... Raises ValueError where
    there is none.
    """
    from contourpy import contour_generator

    light, opacity = brightness(file)
    inside = opacity * ((light - threshold) if bright else (threshold - light)) - (1.0 - opacity)
    padded = np.pad(inside, 1, constant_values=min(-1e-6, float(inside.min())))[::-1]
    found = [np.asarray(line)[:-1] - 0.5 for line in contour_generator(z=padded).lines(0.0)]
    sizes = [abs(_area(ring)) for ring in found]
    order = [k for k in np.argsort(sizes)[::-1] if sizes[k] >= LEAST_AREA]
    if not order:
        raise ValueError(f"nothing in {Path(file).name} is {'brighter' if bright else 'darker'} than {threshold:g}")
    return {f"island{n}" if n else "shore": _simple(found[k]) for n, k in enumerate(order)}


def _area(ring: Floats) -> float:
    x, y = ring.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _simple(ring: Floats) -> Floats:
    """The polygon (k, 2) without duplicate and collinear corners."""
    ring = ring[np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1) > 1e-9]
    a, b = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turns: Floats = ring[np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-12]
    return turns


def sampled(file: str, shares: Floats) -> Floats:
    """Bilinear brightness (k,) at places (k, 2); (0, 0) is the low left corner, (1, 1) the top right."""
    light = brightness(file)[0][::-1]
    height, width = light.shape
    found = np.zeros(len(shares))
    at = np.clip(shares * (width, height) - 0.5, 0.0, (width - 1.0, height - 1.0))
    low = np.floor(at).astype(np.int64)
    part = at - low
    for right in (0, 1):
        for up in (0, 1):
            weight = np.abs(1.0 - right - part[:, 0]) * np.abs(1.0 - up - part[:, 1])
            found += weight * light[np.minimum(low[:, 1] + up, height - 1), np.minimum(low[:, 0] + right, width - 1)]
    return found
