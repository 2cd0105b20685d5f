"""Points moved onto the surface of an object."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats

POLISH = 40
"""Updates."""
STEP = 1e-6
"""Difference of places, in parts of the object's size, by which slopes are taken."""
ROUNDING = 1e-13


def onto(level: Any, size: float, points: Floats, axes: int = 3) -> Floats:
    """(k, 3) points moved along the slope of a level set to where it is 0, along the first ``axes`` only."""
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
