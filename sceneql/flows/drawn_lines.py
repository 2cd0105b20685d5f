"""Lines along a velocity field, by Runge and Kutta's method on its trilinear interpolant."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from sceneql.grids.maps.interpolation import interpolation

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout

PART = 0.8
"""Length of a step, in parts of a cell."""
REST = 1e-6
"""Speed that counts as rest, in parts of the largest."""
LEAST = 4
"""Pieces of a line, shorter ones are left out."""
MOST = 150
"""Steps of a line either way."""


def lines(velocity: Floats, layout: FieldLayout, apart: float, longest: float) -> Floats:
    """Ends (k, 2, 3) of the pieces of lines [m] of velocities (cells, 3), which begin ``apart`` from one another."""
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
        """Unit vectors (k, 3); 0 where the fluid is at rest, or outside."""
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
    taken: set[tuple[int, ...]] = set()
    starts = np.zeros((len(seeds), 3))
    starts[:, :axes] = seeds
    ways = [_way(along, starts, way * step, min(MOST, longest / step)) for way in (1.0, -1.0)]
    pieces = []
    for k in range(len(starts)):
        own: set[tuple[int, ...]] = set()
        if _bucket(starts[k], low, apart, axes) in taken:
            continue
        line = []
        for way in ways:
            path = way[: _last(way[:, k], step), k]
            boxes = [_bucket(point, low, apart, axes) for point in path[1:]]
            free = next((n for n, box in enumerate(boxes) if box in taken), len(boxes))
            line += [path[n : n + 2] for n in range(free)]
            own |= set(boxes[:free])
        if len(line) >= LEAST:
            pieces += line
            taken |= own
    return np.array(pieces).reshape(-1, 2, 3)


def _way(along: Callable[[Floats], Floats], starts: Floats, step: float, most: float) -> Floats:
    """The points (steps, k, 3) of ways from all starts, by the midpoint rule; at rest where a way ends."""
    found = [starts]
    while len(found) <= most:
        at = found[-1]
        change = step * along(at + 0.5 * step * along(at))
        if not change.any():
            break
        found.append(at + change)
    return np.stack(found)


def _last(path: Floats, step: float) -> int:
    """The number of points of a way until it rests, or comes back to its start."""
    still = np.flatnonzero(~np.diff(path, axis=0).any(axis=1))
    count = int(still[0]) + 1 if len(still) else len(path)
    back = np.flatnonzero(np.linalg.norm(path[4:count] - path[0], axis=1) < 0.6 * step)
    return int(back[0]) + 5 if len(back) else count


def _bucket(point: Floats, low: Floats, apart: float, axes: int) -> tuple[int, ...]:
    """The box of half the distance that a point stands in."""
    return tuple(int(k) for k in np.floor((point - low)[:axes] / (0.5 * apart)))
