"""Streamlines of a velocity field, by a Runge-Kutta method on its trilinear interpolant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows import drawn_lines_kernels as kernels
from sceneql.grids.maps.interpolation import interpolation

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout

PART = 0.8
"""Length of a step, in cells."""
REST = 1e-6
"""Speed, relative to the largest, below which fluid counts as at rest."""
LEAST = 4
"""Least number of segments of a line; shorter ones are left out."""
MOST = 150
"""Most steps of a line in each direction."""


def lines(velocity: Floats, layout: FieldLayout, apart: float, longest: float) -> Floats:
    """Segments (k, 2, 3) [m] of streamlines of velocities (cells, 3), seeded ``apart`` [m] from each other.

    ``longest`` [m]: largest length in each direction.
    """
    low, spacing = np.array(layout.low), np.array(layout.spacing)
    size = np.array(layout.shape) * spacing
    axes = 2 if layout.shape[2] == 1 else 3
    fastest = float(np.abs(velocity).max())
    if fastest == 0.0:
        return np.zeros((0, 2, 3))
    between = interpolation(layout, np.ones(layout.count, dtype=bool))
    values = np.stack([between.filled(velocity[:, axis]) for axis in range(axes)])
    step = PART * float(spacing[:axes].min())
    seeds = np.maximum(np.floor(size[:axes] / apart).astype(int), 1)
    rows = [low[k] + (np.arange(n) + 0.5) * size[k] / n for k, n in enumerate(seeds)]
    starts = np.zeros((int(np.prod(seeds)), 3))
    starts[:, :axes] = np.stack(np.meshgrid(*rows, indexing="ij"), axis=-1).reshape(-1, axes)
    side, most = 0.5 * apart, int(min(MOST, max(np.floor(longest / step), 1.0)))
    numbers = np.empty(kernels.NUMBERS)
    numbers[kernels.LOW : kernels.SLOWEST] = *low, *(low + size), *spacing
    numbers[kernels.SLOWEST], numbers[kernels.STEP], numbers[kernels.SIDE] = REST * fastest, step, side
    numbers[kernels.CORNER :] = low - side
    counts = np.empty(kernels.COUNTS, dtype=np.int64)
    counts[kernels.AXES], counts[kernels.MOST], counts[kernels.LEAST] = axes, most, LEAST
    counts[kernels.SHAPE : kernels.BOXES] = values.shape[:0:-1]
    counts[kernels.BOXES : kernels.MOST] = np.ceil(size / side) + 2  # and those outside, in which last steps end
    found = np.empty(12 * len(starts) * most)
    count = kernels.follow(values.ravel(), starts.ravel(), numbers, counts, found)
    return found[: 6 * count].reshape(-1, 2, 3).copy()
