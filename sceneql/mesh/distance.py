"""Distances between meshes. Imports numpy and scipy: to be imported by the function that needs it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

NEIGHBORS = 24
"""Number of triangles, those with the nearest centers, among which the one nearest to a point is searched."""
FLAT = 1e-20
"""Squared sine of an angle of a triangle below which it counts as degenerate."""
BATCH = 4096


def hausdorff(a: tuple[Floats, Ints], b: tuple[Floats, Ints], most: int = 50_000) -> float:
    """Hausdorff distance [m] of two meshes (vertices, triangles), measured at vertices and triangles' centers of both.

    At most ``most`` points of each mesh, at equal steps of their order. Infinite if only one mesh has triangles.
    """
    if not len(a[1]) or not len(b[1]):
        return 0.0 if len(a[1]) == len(b[1]) else np.inf
    return max(_farthest(a, b, most), _farthest(b, a, most))


def _farthest(mesh: tuple[Floats, Ints], other: tuple[Floats, Ints], most: int) -> float:
    """Largest distance [m] of a mesh's points from another mesh."""
    points = np.concatenate([mesh[0][np.unique(mesh[1])], mesh[0][mesh[1]].mean(axis=1)])
    points = points[:: -(-len(points) // most)]
    return float(distances(points, *other).max())


def distances(points: Floats, vertices: Floats, triangles: Ints) -> Floats:
    """(n,) distances [m] of points (n, 3) from the nearest of those NEIGHBORS triangles whose centers are nearest."""
    corners = vertices[triangles]
    tree = cKDTree(corners.mean(axis=1))
    out = np.empty(len(points))
    for begin in range(0, len(points), BATCH):
        some = points[begin : begin + BATCH]
        _, near = tree.query(some, min(NEIGHBORS, len(triangles)))
        candidates = corners[near.reshape(len(some), -1)]
        out[begin : begin + BATCH] = to_triangles(some[:, None], candidates).min(axis=1)
    return out


def to_triangles(points: Floats, corners: Floats) -> Floats:
    """(...) distances [m] of points (..., 3) from triangles (..., 3, 3)."""
    a, b, c = (corners[..., k, :] for k in range(3))
    normal = np.cross(b - a, c - a)
    square = np.einsum("...i,...i", normal, normal)
    height = np.einsum("...i,...i", points - a, normal)
    size = np.maximum(np.einsum("...i,...i", b - a, b - a), np.einsum("...i,...i", c - a, c - a))
    inside = square > FLAT * size * size  # to a degenerate triangle only the distance from its edges is used
    square = np.where(inside, square, 1.0)
    foot = points - (height / square)[..., None] * normal
    least = np.full(height.shape, np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        side = q - p
        inside &= np.einsum("...i,...i", np.cross(side, foot - p), normal) >= 0.0
        way = np.einsum("...i,...i", points - p, side) / np.maximum(np.einsum("...i,...i", side, side), 1e-300)
        to_edge = np.linalg.norm(points - p - np.clip(way, 0.0, 1.0)[..., None] * side, axis=-1)
        least = np.minimum(least, to_edge)
    return np.where(inside, np.abs(height) / np.sqrt(square), least)
