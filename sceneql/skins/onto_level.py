"""Projection of points onto the zero surface of a level."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats

POLISH = 40
"""Largest number of Newton steps."""
STEP = 1e-6
"""Step of central differences, relative to the object's size."""
ROUNDING = 1e-13


def onto(level: Any, size: float, points: Floats, axes: int = 3) -> Floats:
    """Points (k, 3) [m] moved along a level's gradient to where it is 0; only the first ``axes`` coordinates change."""
    found, step = points.copy(), STEP * size
    for _ in range(POLISH):
        values = level.values(found)
        slopes = np.zeros_like(found)
        for axis in range(axes):
            shift = step * np.eye(3)[axis]
            slopes[:, axis] = (level.values(found + shift) - level.values(found - shift)) / (2.0 * step)
        squares = (slopes**2).sum(axis=1)
        move = np.divide(values, squares, out=np.zeros_like(values), where=squares > 0.0)[:, None] * slopes
        found -= move
        if np.abs(move).max() < ROUNDING * size:
            break
    return found
