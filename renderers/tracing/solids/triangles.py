"""Packing of meshes; the data of large meshes that are held is kept from frame to frame."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from renderers.tracing.solids.hierarchy import Tree
from sceneql.shapes.held_arrays import OfHeld

if TYPE_CHECKING:
    from sceneql.frame import Floats, Mesh

LARGE = 4096
"""Triangles from which on a held mesh has a hierarchy of its own: below it would save less than it costs."""


class Packed(NamedTuple):
    """A mesh with a hierarchy of its own."""

    tree: Tree
    rows: Floats
    """(m, 27) reals of its items."""


_trees: OfHeld[Tree] = OfHeld()
_rows: OfHeld[Floats] = OfHeld()


def still_mesh(mesh: Mesh) -> Packed:
    """The hierarchy and the reals of a mesh that is held: those of the last frame, if it is the same."""
    corners = cache(lambda: corners_of(mesh))
    tree = _trees.get((mesh.vertices, mesh.triangles), None, lambda: Tree(boxes_of(corners())))
    whole = mesh.vertices, mesh.triangles, mesh.normals, told_at_corners(mesh)
    return Packed(tree, _rows.get(whole, None, lambda: rows_of(mesh, corners())))


def corners_of(mesh: Mesh) -> Floats:
    """(m, 3, 3) vertices of the triangles."""
    return np.asarray(mesh.vertices, dtype=np.float64)[mesh.triangles]


def boxes_of(corners: Floats) -> Floats:
    """(m, 6) bounds of triangles (m, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.concatenate([np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)], axis=1)


def rows_of(mesh: Mesh, corners: Floats) -> Floats:
    """(m, 27) reals of triangles (m, 3, 3): a corner, two edges; normals, and what is told, at the corners (NaN)."""
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
    """(n, 3) the places of the material of a mesh that is painted, else its colors."""
    return mesh.colors if mesh.paint is None else mesh.rest
