"""A smooth line through points: a C1 chain of quadratic Bezier curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats

OFF = 3e-4
"""Largest deviation of the quadratic curves from the cubic, relative to the smaller radius at the piece's ends."""
MOST = 64
"""Most pairs of curves between two points."""
HELD = 0.5
"""Lower bound of the radius between points, relative to the least radius at the points."""


def smooth(points: Floats, radii: Floats, closed: bool) -> tuple[Floats, Floats]:
    """(corners (m, 3, 3) [m], radii (m, 3) [m]) of quadratic Bezier curves along a cubic spline through points (n, 3).

    Corners of a curve: first end, last end, control point. The spline's slopes are those of chords (Catmull & Rom
    1974), its parameter is the chord length, as along the path of a `motion`. Each piece of it is replaced by a pair of
    quadratic curves that meet in the middle, with the piece's positions and slopes at both ends (Powell & Sabin 1977,
    in one dimension). A closed line's last point equals its first. Radii (n,) are interpolated by the same spline, with
    a lower bound (HELD).
    """
    import numpy as np

    data = np.column_stack([points, radii])
    steps = np.linalg.norm(points[1:] - points[:-1], axis=1)
    t = np.concatenate([[0.0], np.cumsum(steps)])
    slopes = np.empty_like(data)
    slopes[1:-1] = (data[2:] - data[:-2]) / (t[2:] - t[:-2])[:, None]
    slopes[0] = (data[1] - data[0]) / steps[0]
    slopes[-1] = (data[-1] - data[-2]) / steps[-1]
    behind, ahead = np.concatenate([steps[:1], steps]), np.concatenate([steps, steps[-1:]])
    if closed:
        slopes[0] = slopes[-1] = (data[1] - data[-2]) / (steps[0] + steps[-1])
        behind[0], ahead[-1] = steps[-1], steps[0]
    # A cubic lies in the hull of its control points, and those are a third of its end slopes away from its ends.
    room = 3.0 * (radii - HELD * radii.min())
    slopes[:, 3] = np.clip(slopes[:, 3], -room / ahead, room / behind)
    found = []
    for k, h in enumerate(steps):
        a, b, p, q = data[k], data[k + 1], h * slopes[k], h * slopes[k + 1]
        # The pair deviates by t (1 - t)^2/48 times the third derivative, t from the middle to an end: 1/324 at most.
        third = float(np.linalg.norm(12.0 * (a - b) + 6.0 * (p + q)))
        n = int(np.clip(np.ceil(np.cbrt(third / (324.0 * OFF * min(radii[k], radii[k + 1])))), 1, MOST))
        s = (np.arange(n + 1) / n)[:, None]
        places = (2 * s**3 - 3 * s**2 + 1) * a + (s**3 - 2 * s**2 + s) * p + (3 * s**2 - 2 * s**3) * b
        places += (s**3 - s**2) * q
        ways = (6 * (s**2 - s) * (a - b) + (3 * s**2 - 4 * s + 1) * p + (3 * s**2 - 2 * s) * q) / (4 * n)
        first, last = places[:-1] + ways[:-1], places[1:] - ways[1:]
        middle = 0.5 * (first + last)
        pairs = np.stack([places[:-1], middle, first, middle, places[1:], last], axis=1)
        found.append(pairs.reshape(2 * n, 3, 4))
    curves = np.concatenate(found)
    return curves[:, :, :3].copy(), curves[:, :, 3].copy()
