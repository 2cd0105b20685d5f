"""Outlines: few points whose convex hull nearly contains a shape, for a camera that is fitted tighter than to a box.

The hull of a round shape is inscribed: that of the unit sphere has points at distance 0.96 from the center.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Mesh, Points, Quadric, Segments
from sceneql.shapes.placement import apply, inverse
from sceneql.shapes.world_boxes import box_of, inside_samples

if TYPE_CHECKING:
    from numpy import intp
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Shape

COUNT = 96
"""Directions in each of which the farthest point is searched."""
AT_ONCE = 50_000
"""Vertices or spheres of one block of the search, which bounds its memory."""
CLOUD, STRAYS = 200, 0.02
"""Number of spheres from which on they count as a cloud; share of a cloud's spheres that may lie beyond its outline in
each direction, so that the camera does not zoom out for a few stars far away."""


def _directions() -> Floats:
    """(COUNT, 3) unit vectors, evenly spread by the golden angle."""
    k = np.arange(COUNT) + 0.5
    up, turn = 1.0 - 2.0 * k / COUNT, np.pi * (1.0 + 5.0**0.5) * k
    across = np.sqrt(1.0 - up * up)
    return np.column_stack([across * np.cos(turn), up, across * np.sin(turn)])


DIRECTIONS = _directions()


def outline(shape: Shape) -> Floats:
    """Points (n, 3) [m], at most about COUNT, whose hull nearly contains a shape; none if it is empty or unbounded."""
    match shape:
        case Mesh(vertices=points):
            return outermost(points)
        case Points(centers=points, radii=radii) if len(points) < CLOUD:
            return _around(points, radii)
        case Points(centers=points, radii=radii):
            return _cloud(points, radii)
        case Segments(ends=ends, radii=radii):
            return _around(ends.reshape(-1, 3), np.repeat(radii, 2))
        case Quadric(linear=linear) if not any(linear):
            return _quadric(shape)
    found = inside_samples(shape)
    if found is not None:
        points, step = found
        return _around(points, np.full(len(points), 0.5 * float(np.linalg.norm(step))))
    corners = np.array(list(product(*zip(*box_of(shape), strict=True))))
    return corners if np.isfinite(corners).all() else np.zeros((0, 3))


def outermost(points: Floats) -> Floats:
    """The points, of (n, 3), that are farthest along any of the DIRECTIONS; all points if there are at most COUNT."""
    if len(points) <= COUNT:
        return points
    found: Floats = points[np.unique(_farthest(points, 0.0))]
    return found


def _around(centers: Floats, radii: Floats) -> Floats:
    """(COUNT, 3) the farthest points, in each direction, of spheres with centers (n, 3) and radii (n,) [m]."""
    if len(centers) == 0:
        return centers.reshape(-1, 3)
    farthest = _farthest(centers, radii[:, None])
    found: Floats = centers[farthest] + radii[farthest, None] * DIRECTIONS
    return found


def _cloud(centers: Floats, radii: Floats) -> Floats:
    """(COUNT, 3) as ``_around``, but in each direction without the share STRAYS of farthest spheres.

    More than AT_ONCE spheres are sampled at equal steps.
    """
    every = -(-len(centers) // AT_ONCE)
    some, reach = centers[::every], radii[::every]
    along = some @ DIRECTIONS.T + reach[:, None]
    last = len(some) - 1 - int(STRAYS * len(some))
    farthest = np.argpartition(along, last, axis=0)[last]
    found: Floats = some[farthest] + reach[farthest, None] * DIRECTIONS
    return found


def _quadric(shape: Quadric) -> Floats:
    """The farthest points of an ellipsoid, cylinder or block, clipped at its box; none of an unbounded one.

    In direction d: along the axes with a square term A A^T d / |A^T d|, where A maps the unit ball to the solid, and
    along the other axes the end of the box that d points to.
    """
    squares = np.array(shape.squares)
    if not shape.constant < 0.0:
        return np.zeros((0, 3))
    half = np.sqrt(-shape.constant / np.where(squares > 0.0, squares, np.inf))
    to_world = inverse(shape.to_local)
    along = DIRECTIONS @ to_world[:, :3]
    from_ball = along * half
    from_ball /= np.maximum(np.linalg.norm(from_ball, axis=1), np.finfo(float).tiny)[:, None]
    ends = np.where(along > 0.0, shape.high, shape.low)
    local = np.where(squares > 0.0, np.clip(half * from_ball, shape.low, shape.high), ends)
    return apply(to_world, np.unique(local, axis=0)) if np.isfinite(local).all() else np.zeros((0, 3))


def _farthest(points: Floats, reach: Floats | float) -> NDArray[intp]:
    """Indices (COUNT,) of the balls farthest in each direction, with centers (n, 3) and radii ``reach`` (n, 1) [m]."""
    best, far = np.zeros(COUNT, dtype=np.intp), np.full(COUNT, -np.inf)
    for start in range(0, len(points), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        along = DIRECTIONS @ points[some].T + (reach if isinstance(reach, float) else reach[some, 0])
        last = np.argmax(along, axis=1)
        there = along[np.arange(COUNT), last]
        best, far = np.where(there > far, start + last, best), np.maximum(there, far)
    return best
