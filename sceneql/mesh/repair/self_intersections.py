"""Self-intersections of triangle meshes. Imports numpy and scipy: to be imported where it is needed."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sceneql.mesh.cubes.triangle_kernels import in_cubes
from sceneql.mesh.repair.folds import INSIDE, extents

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

    Rows = NDArray[np.int64]

CUBES = 128
"""Most cubes along the side of the bounding box in which triangles near given ones are searched."""


def self_intersections(places: Floats, triangles: Ints, rows: Rows) -> tuple[Rows, Rows]:
    """Pairs of intersecting triangles without a common side: (row among ``rows`` (n,), row of ``triangles`` (t, 3)).

    Two triangles intersect if a side of one pierces the interior of the other; coplanar ones never do.
    """
    near = _near(places, triangles, rows)
    corners = places[triangles[near]]
    least, most = extents(corners)
    middles, halves = 0.5 * (least + most), 0.5 * (most - least)
    own = np.searchsorted(near, rows)
    # Boxes that overlap have centers within this distance, in the maximum norm.
    reach = halves[own].max(axis=1) + halves.max()
    found = cKDTree(middles).query_ball_point(middles[own], reach, p=np.inf)
    first = np.repeat(own, [len(some) for some in found])
    other = np.concatenate([np.array(some, dtype=np.int64) for some in found])
    shared = (triangles[near[first]][:, :, None] == triangles[near[other]][:, None, :]).sum(axis=(1, 2))
    meet = (np.abs(middles[first] - middles[other]) <= halves[first] + halves[other]).all(axis=1) & (shared < 2)
    first, other = first[meet], other[meet]
    through = np.zeros(len(first), dtype=bool)
    for k in range(3):
        side = [k, (k + 1) % 3]
        through |= _pierced(corners[first][:, side], corners[other])
        through |= _pierced(corners[other][:, side], corners[first])
    return near[first[through]], near[other[through]]


def _near(places: Floats, triangles: Ints, rows: Rows) -> Rows:
    """(m,) ascending rows of triangles (t, 3) that share a cube with one of the triangles ``rows`` (n,), or are one."""
    least, most = extents(places[triangles[rows]])
    first = least.min(axis=0)
    size = (most.max(axis=0) - first).max()
    width = INSIDE * max((most - least).max(), size / CUBES) or 1.0
    ends = ((np.stack([least, most]) - first) / width).astype(np.int64)
    marked = np.zeros(ends.max(axis=(0, 1)) + 1, dtype=bool)
    for x, y, z in product((0, 1), repeat=3):
        marked[ends[x, :, 0], ends[y, :, 1], ends[z, :, 2]] = True
    found = np.empty(len(triangles), dtype=np.int64)
    return found[: in_cubes(places, triangles, marked, first, width, found)]


def _pierced(sides: Floats, corners: Floats) -> NDArray[np.bool_]:
    """(n,) whether segments (n, 2, 3) pierce the interiors of triangles (n, 3, 3)."""
    first, last = sides[:, 0], sides[:, 1]
    a, b, c = (corners[:, k] for k in range(3))
    normals = np.cross(b - a, c - a)
    across = np.einsum("nj,nj->n", first - a, normals) * np.einsum("nj,nj->n", last - a, normals) < 0.0
    # The segment's line passes all three sides of the triangle on the same hand.
    hands = np.stack(
        [np.einsum("nj,nj->n", np.cross(p - first, q - first), last - first) for p, q in ((a, b), (b, c), (c, a))]
    )
    found: NDArray[np.bool_] = across & ((hands > 0.0).all(axis=0) | (hands < 0.0).all(axis=0))
    return found
