"""Triangles that pass through others of their mesh. Imports numpy and scipy: to be imported where it is needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sceneql.mesh.folds import extents

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

    Rows = NDArray[np.int64]


def passing(places: Floats, triangles: Ints, rows: Rows) -> tuple[Rows, Rows]:
    """Pairs of rows: of the triangles ``rows`` (n,), and of those (t, 3) that pass through them without a common side.

    One passes through the other where a side of one of them meets the inside of the other. Those in one plane do not.
    """
    corners = places[triangles]
    least, most = extents(corners)
    middles, halves = 0.5 * (least + most), 0.5 * (most - least)
    # Boxes that meet those of the rows are among all whose middles are so near.
    near = np.flatnonzero(((most >= least[rows].min(axis=0)) & (least <= most[rows].max(axis=0))).all(axis=1))
    reach = halves[rows].max(axis=1) + halves[near].max()
    found = cKDTree(middles[near]).query_ball_point(middles[rows], reach, p=np.inf)
    first = np.repeat(rows, [len(some) for some in found])
    other = near[np.concatenate([np.array(some, dtype=np.int64) for some in found])]
    shared = (triangles[first][:, :, None] == triangles[other][:, None, :]).sum(axis=(1, 2))
    meet = (np.abs(middles[first] - middles[other]) <= halves[first] + halves[other]).all(axis=1) & (shared < 2)
    first, other = first[meet], other[meet]
    through = np.zeros(len(first), dtype=bool)
    for k in range(3):
        side = [k, (k + 1) % 3]
        through |= _pierced(corners[first][:, side], corners[other])
        through |= _pierced(corners[other][:, side], corners[first])
    return first[through], other[through]


def _pierced(sides: Floats, corners: Floats) -> NDArray[np.bool_]:
    """(n,) whether sides (n, 2, 3) pass through the insides of triangles (n, 3, 3)."""
    first, last = sides[:, 0], sides[:, 1]
    a, b, c = (corners[:, k] for k in range(3))
    normals = np.cross(b - a, c - a)
    across = np.einsum("nj,nj->n", first - a, normals) * np.einsum("nj,nj->n", last - a, normals) < 0.0
    # The line passes all three sides of the triangle on the same hand.
    hands = np.stack(
        [np.einsum("nj,nj->n", np.cross(p - first, q - first), last - first) for p, q in ((a, b), (b, c), (c, a))]
    )
    found: NDArray[np.bool_] = across & ((hands > 0.0).all(axis=0) | (hands < 0.0).all(axis=0))
    return found
