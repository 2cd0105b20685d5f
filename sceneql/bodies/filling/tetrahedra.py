"""Tetrahedral meshes: volumes, edges and boundary triangles. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

ENDS = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
"""The edges of a tetrahedron, by its corners; edges k and 5 - k are opposite."""
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
"""The faces of a tetrahedron, counterclockwise from outside; face k is opposite to corner k."""


def volumes(points: Floats, tetrahedra: Ints) -> Floats:
    """Signed volumes (t,) [m^3] of tetrahedra (t, 4) of points (n, 3) [m]; negative for an inverted one."""
    a, b, c, d = points[tetrahedra].transpose(1, 0, 2)
    held: Floats = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6.0
    return held


def edges(tetrahedra: Ints) -> tuple[NDArray[int64], NDArray[int64]]:
    """Unique edges (e, 2), the lower end first; and for each tetrahedron (t, 6) their numbers in the order of ENDS."""
    ends = np.sort(tetrahedra[:, ENDS].astype(np.int64), axis=2).reshape(-1, 2)
    size = int(ends.max(initial=0)) + 1
    keys, which = np.unique(ends @ (size, 1), return_inverse=True)
    return np.stack(np.divmod(keys, size), axis=1), which.reshape(-1, 6)


def boundary(tetrahedra: Ints) -> Ints:
    """Outer faces (k, 3), those of only one tetrahedron, counterclockwise from outside."""
    faces = tetrahedra[:, FACES].reshape(-1, 3)
    low, middle, high = np.sort(faces.astype(np.int64), axis=1).T
    size = int(high.max(initial=0)) + 1
    _, first, count = np.unique((low * size + middle) * size + high, return_index=True, return_counts=True)
    found: Ints = faces[np.sort(first[count == 1])].astype(np.int32)
    return found
