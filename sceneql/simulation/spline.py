"""A smooth line through points, as a chain of short straight pieces."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats

OFF = 3e-4
"""How far the pieces may lie off the curve, in parts of the radius there."""
MOST = 64
"""Pieces between two points."""


def smooth(points: Floats, radii: Floats, closed: bool) -> tuple[Floats, Floats]:
    """(places (m, 3), radii (m,)) along the cubic through points (n, 3) with the slopes of chords (Catmull & Rom 1974).

    Its parameter is the length of the polygon, as along the path of a `motion`. Of a closed line the last point is the
    first. The radius goes the same way.
    """
    import numpy as np

    data = np.column_stack([points, radii])
    steps = np.linalg.norm(points[1:] - points[:-1], axis=1)
    t = np.concatenate([[0.0], np.cumsum(steps)])
    slopes = np.empty_like(data)
    slopes[1:-1] = (data[2:] - data[:-2]) / (t[2:] - t[:-2])[:, None]
    slopes[0] = (data[1] - data[0]) / steps[0]
    slopes[-1] = (data[-1] - data[-2]) / steps[-1]
    if closed:
        slopes[0] = slopes[-1] = (data[1] - data[-2]) / (steps[0] + steps[-1])
    found = [data[:1]]
    for k, h in enumerate(steps):
        a, b, p, q = data[k], data[k + 1], h * slopes[k], h * slopes[k + 1]
        # The second derivative of a cubic is largest at an end; a chord of 1/n of it lies within bend/(8 n^2).
        bend = max(np.linalg.norm((6 * (b - a) - 4 * p - 2 * q)[:3]), np.linalg.norm((6 * (a - b) + 2 * p + 4 * q)[:3]))
        n = int(np.clip(np.ceil(np.sqrt(bend / (8 * OFF * min(radii[k], radii[k + 1])))), 1, MOST))
        s = (np.arange(1, n + 1) / n)[:, None]
        found.append(
            (2 * s**3 - 3 * s**2 + 1) * a + (s**3 - 2 * s**2 + s) * p + (3 * s**2 - 2 * s**3) * b + (s**3 - s**2) * q
        )
    path = np.concatenate(found)
    return path[:, :3], np.maximum(path[:, 3], radii.min())
