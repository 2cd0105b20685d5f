"""Closed meshes: fills holes, computes normals of faces, edges and vertices, and a box tree of the triangles.

For the nearest points of `contacts/shapes/mesh_kernels.py`. Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.mesh.box_tree import box_tree
from sceneql.mesh.holes import caps, open_sides, welded
from sceneql.shapes.of_contents import OfContents

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

LEAF = 4
"""Largest number of triangles in a leaf of the tree."""
MISSING = 0.55
"""Largest area of the hole fillings, relative to the mesh: a hemisphere (0.5) may be closed."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosedMesh:
    """Closed surface with outward triangles and a box tree."""

    vertices: Floats
    """(n, 3) [m]."""
    corners: Floats
    """(m, 3, 3) [m]: corners of the triangles, outward."""
    rows: Floats
    """(m, 30), in the tree's order: corners, then unit normals of the face, the edges 01, 12, 20 and the vertices."""
    boxes: Floats
    """(b, 6) [m]: low and high corners of boxes, depth first."""
    tree: NDArray[int64]
    """(b, 3): next box outside this one in depth-first order, first triangle, number of triangles (0: no leaf)."""


def closed(vertices: Floats, triangles: Ints) -> ClosedMesh:
    """Closed mesh of vertices (n, 3) [m] and triangles (m, 3); fans of triangles fill holes.

    Raises ValueError for a mesh with too large holes, and for one with edges of more than two triangles.
    """
    return _KNOWN.get((vertices, triangles), lambda: _closed(vertices, triangles))


_KNOWN: OfContents[ClosedMesh] = OfContents()


def _closed(vertices: Floats, triangles: Ints) -> ClosedMesh:
    vertices, triangles = _filled(*welded(vertices, triangles))
    corners = vertices[triangles]
    if np.einsum("ij,ij", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) < 0.0:
        triangles = triangles[:, ::-1]
        corners = corners[:, ::-1]
    order, boxes, tree = box_tree(corners, LEAF)
    rows = np.concatenate([corners.reshape(-1, 9), _normals(vertices, triangles)], axis=1)[order]
    return ClosedMesh(vertices, corners, rows, boxes, tree)


def _filled(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Welded mesh with holes filled. Raises ValueError unless every edge then has two triangles, one on each side."""
    if not len(triangles):
        raise ValueError("its mesh has no triangle of any area")
    sides = open_sides(triangles)
    if _doubled(triangles):
        raise ValueError("its mesh has edges with more than two triangles, or triangles that face different ways")
    if not len(sides):
        return vertices, triangles
    with_middles, lids = caps(vertices, sides)
    if _area(with_middles, lids) > MISSING * _area(vertices, triangles):
        raise ValueError(f"its mesh is open: {len(sides)} edges have a triangle on one side only, so it has no inside")
    return with_middles, np.concatenate([triangles, lids])


def _doubled(triangles: Ints) -> bool:
    """Whether two triangles share an edge in the same direction."""
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    keys = np.sort(sides @ (int(sides.max()) + 1, 1))
    return bool((keys[1:] == keys[:-1]).any())


def _area(vertices: Floats, triangles: Ints) -> float:
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def _normals(vertices: Floats, triangles: Ints) -> Floats:
    """Unit normals (m, 21) of each triangle's face, edges 01, 12, 20 and vertices, the last weighted by angle."""
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    at_vertices = np.zeros_like(vertices)
    for k in range(3):
        u = corners[:, (k + 1) % 3] - corners[:, k]
        v = corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), np.einsum("ij,ij->i", u, v))
        np.add.at(at_vertices, triangles[:, k], angle[:, None] * faces)
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64), axis=1)
    _, edge = np.unique(ends @ (len(vertices), 1), return_inverse=True)
    at_edges = np.zeros((edge.max() + 1, 3))
    np.add.at(at_edges, edge, np.repeat(faces, 3, axis=0))
    return np.concatenate(
        [faces, _unit(at_edges)[edge].reshape(-1, 9), _unit(at_vertices)[triangles].reshape(-1, 9)], axis=1
    )


def _unit(vectors: Floats) -> Floats:
    units: Floats = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
    return units
