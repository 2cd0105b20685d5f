"""Perceptually uniform color maps: curves through control colors in OKLab."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.grids.maps.map_names import CONTROLS
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import Floats

SIZE = 512
"""Colors in a table."""

TO_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
TO_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
"""TO_CONES maps linear sRGB to cone responses, TO_LAB their cube roots to L, a, b (Ottosson 2020, A perceptual color
space)."""


def oklab(rgb: Any) -> Floats:
    """OKLab (..., 3) of linear RGB (..., 3)."""
    lab: Floats = np.cbrt(np.asarray(rgb, dtype=float) @ TO_CONES.T) @ TO_LAB.T
    return lab


def from_oklab(lab: Any) -> Floats:
    """Linear RGB (..., 3) of OKLab (..., 3), clipped to 0..1."""
    rgb = (np.asarray(lab, dtype=float) @ np.linalg.inv(TO_LAB).T) ** 3 @ np.linalg.inv(TO_CONES).T
    shown: Floats = np.clip(rgb, 0.0, 1.0)
    return shown


@cache
def table(name: str) -> Floats:
    """Linear RGB (SIZE, 3) of a color map at even steps from its low to its high end."""
    hexes = CONTROLS[name].split()
    rgb = [linear(int(text[k : k + 2], 16) / 255 for k in (0, 2, 4)) for text in hexes]
    return from_oklab(_curve(oklab(rgb), np.linspace(0.0, len(hexes) - 1.0, SIZE)))


def _curve(points: Floats, t: Floats) -> Floats:
    """Values (k, 3) at t (k,) of the cubic spline through points (n, 3) at 0, 1, ... (Catmull & Rom 1974).

    Slopes are limited to three chords, so that components are monotone between points (Fritsch & Carlson 1980).
    """
    chords = np.diff(points, axis=0)
    before, after = np.concatenate([chords[:1], chords]), np.concatenate([chords, chords[-1:]])
    slopes = 0.5 * (before + after)
    limit = 3.0 * np.minimum(abs(before), abs(after))
    slopes = np.where(before * after > 0.0, np.clip(slopes, -limit, limit), 0.0)
    k = np.clip(np.floor(t).astype(int), 0, len(points) - 2)
    s = (t - k)[:, None]
    rise = s * s * (3.0 - 2.0 * s)
    bend = s * (1.0 - s) * ((1.0 - s) * slopes[k] - s * slopes[k + 1])
    found: Floats = points[k] + rise * chords[k] + bend
    return found


def colored(values: Floats, scale: tuple[float, float], name: str) -> Floats:
    """Linear RGB (n, 3) of values (n,), mapped from ``scale`` (low, high) to the color map's ends and clipped."""
    low, high = scale
    place = np.clip((values - low) / (high - low), 0.0, 1.0) * (SIZE - 1)
    first = np.minimum(place.astype(int), SIZE - 2)
    share = (place - first)[:, None]
    colors = table(name)
    found: Floats = (1.0 - share) * colors[first] + share * colors[first + 1]
    return found
