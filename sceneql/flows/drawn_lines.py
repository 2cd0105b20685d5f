"""Streamlines of a velocity field, by a Runge-Kutta method on its trilinear interpolant."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.drawn_lines_kernels import choose
from sceneql.grids.maps.interpolation import interpolation

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout

PART = 0.8
"""Length of a step, in cells."""
REST = 1e-6
"""Speed, relative to the largest, below which fluid counts as at rest."""
OUT = 1e-6
"""Relative overshoot of a line's last step beyond the box, where the line then ends."""
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
    flat = layout.shape[2] == 1
    axes = 2 if flat else 3
    between = interpolation(layout, np.ones(layout.count, dtype=bool))
    fields = [between.filled(velocity[:, axis]) for axis in range(axes)]
    fastest = float(np.abs(velocity).max())
    if fastest == 0.0:
        return np.zeros((0, 2, 3))

    def along(points: Floats) -> Floats:
        """Unit vectors (k, 3) along the velocity at points (k, 3); 0 where the fluid is at rest, and outside."""
        found = np.zeros((len(points), 3))
        for axis in range(axes):
            found[:, axis] = between.at(fields[axis], points)
        speed = np.linalg.norm(found, axis=1)
        inside = ((points >= low) & (points <= low + size))[:, :axes].all(axis=1)
        moving = inside & (speed > REST * fastest)
        unit: Floats = np.where(moving[:, None], found / np.where(moving, speed, 1.0)[:, None], 0.0)
        return unit

    step = PART * float(spacing[:axes].min())
    counts = np.maximum(np.floor(size / apart).astype(int), 1)
    rows = [low[k] + (np.arange(counts[k]) + 0.5) * size[k] / counts[k] for k in range(axes)]
    seeds = np.stack(np.meshgrid(*rows, indexing="ij"), axis=-1).reshape(-1, axes)
    starts = np.zeros((len(seeds), 3))
    starts[:, :axes] = seeds
    high = np.where(np.arange(3) < axes, low + size, np.inf)
    ways = [_way(along, starts, way * step, min(MOST, longest / step), (low, high)) for way in (1.0, -1.0)]
    found = np.empty(2 * (ways[0].size + ways[1].size))
    side = 0.5 * apart
    boxes = np.ceil(size / side).astype(np.int64) + 2  # and those that the last steps of lines end in, outside
    paths = (way.ravel() for way in ways)
    count = choose(*paths, len(starts), low - side, side, step, boxes, axes, LEAST, found)
    return found[: 6 * count].reshape(-1, 2, 3).copy()


def _way(
    along: Callable[[Floats], Floats], starts: Floats, step: float, most: float, box: tuple[Floats, Floats]
) -> Floats:
    """Points (steps, k, 3) [m] of lines from all starts by the midpoint rule; an ended line repeats its last point."""
    found = [starts]
    while len(found) <= most:
        at = found[-1]
        change = step * along(at + 0.5 * step * along(at))
        if not change.any():
            break
        found.append(at + change * _part_within(at, change, *box)[:, None])
    return np.stack(found)


def _part_within(at: Floats, change: Floats, low: Floats, high: Floats) -> Floats:
    """Share (k,) of each move (k, 3) up to the box's side, plus OUT so that the next point is outside."""
    with np.errstate(divide="ignore", invalid="ignore"):
        wall = np.where(change > 0.0, high - at, low - at) / change
    part: Floats = np.minimum(1.0, np.where(change != 0.0, wall, np.inf).min(axis=1) * (1.0 + OUT))
    return part
