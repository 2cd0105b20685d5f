"""Packing of meshes; the data of large held meshes is reused from frame to frame."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from renderers.tracing.solids.hierarchy import Tree
from sceneql.shapes.held_arrays import OfHeld

if TYPE_CHECKING:
    from sceneql.frame import Floats, Mesh

LARGE = 4096
"""Least number of triangles for which a held mesh gets its own hierarchy: for fewer it costs more than it saves."""


class Packed(NamedTuple):
    """Mesh with its own hierarchy."""

    tree: Tree
    rows: Floats
    """(m, 27): reals of its items."""


_trees: OfHeld[Tree] = OfHeld()
_rows: OfHeld[Floats] = OfHeld()


def still_mesh(mesh: Mesh) -> Packed:
    """Hierarchy and reals of a held mesh: those of the last frame, if the mesh is the same."""
    corners = cache(lambda: corners_of(mesh))
    tree = _trees.get((mesh.vertices, mesh.triangles), None, lambda: Tree(boxes_of(corners())))
    whole = mesh.vertices, mesh.triangles, mesh.normals, told_at_corners(mesh)
    return Packed(tree, _rows.get(whole, None, lambda: rows_of(mesh, corners())))


def corners_of(mesh: Mesh) -> Floats:
    """Vertices (m, 3, 3) [m] of the triangles."""
    return np.asarray(mesh.vertices, dtype=np.float64)[mesh.triangles]


def boxes_of(corners: Floats) -> Floats:
    """Bounds (m, 6) of triangles (m, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.concatenate([np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)], axis=1)


def rows_of(mesh: Mesh, corners: Floats) -> Floats:
    """Reals (m, 27) of triangles (m, 3, 3): corner, two edges, normals, and colors or rest places at the corners.

    Absent normals, colors and places are NaN.
    """
    rows = np.full((len(corners), 27), np.nan)
    rows[:, :3] = corners[:, 0]
    rows[:, 3:9] = (corners[:, 1:] - corners[:, :1]).reshape(-1, 6)
    if mesh.normals is not None:
        rows[:, 9:18] = np.asarray(mesh.normals)[mesh.triangles].reshape(-1, 9)
    told = told_at_corners(mesh)
    if told is not None:
        rows[:, 18:] = np.asarray(told)[mesh.triangles].reshape(-1, 9)
    return rows


def told_at_corners(mesh: Mesh) -> Floats | None:
    """Rest places (n, 3) [m] of the vertices of a painted mesh, colors (n, 3) of others; None without either."""
    return mesh.colors if mesh.paint is None else mesh.rest
