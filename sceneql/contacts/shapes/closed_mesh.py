"""Closed meshes: whether they are closed, the normals of their features, and a tree of boxes around their triangles.

For the nearest points of `contacts/shapes/mesh_kernels.py`. Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

LEAF = 4
"""Most triangles of a leaf of the tree."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosedMesh:
    """A closed surface whose triangles face outwards, in the order of the tree around them."""

    vertices: Floats
    """(n, 3)."""
    corners: Floats
    """(m, 3, 3)."""
    rows: Floats
    """(m, 30): corners, then unit normals of the face, of the edges 01, 12, 20 and of the vertices."""
    boxes: Floats
    """(b, 6) low and high corners, depth first."""
    tree: NDArray[int64]
    """(b, 3) next box outside this one in depth-first order, first triangle, number of triangles (0: no leaf)."""


def closed(vertices: Floats, triangles: Ints) -> ClosedMesh:
    """From vertices (n, 3) and triangles (m, 3). Raises ValueError for a mesh that is not closed."""
    vertices, triangles = _welded(vertices, triangles)
    _must_be_closed(triangles)
    corners = vertices[triangles]
    if np.einsum("ij,ij", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) < 0.0:
        triangles = triangles[:, ::-1]
        corners = corners[:, ::-1]
    order, boxes, tree = _tree(corners)
    rows = np.concatenate([corners.reshape(-1, 9), _normals(vertices, triangles)], axis=1)[order]
    return ClosedMesh(vertices, corners, rows, boxes, tree)


def _welded(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """The mesh with coincident vertices merged and triangles without area left out."""
    places, same = np.unique(vertices, axis=0, return_inverse=True)
    triangles = same.reshape(-1)[triangles].astype(np.int32)
    corners = places[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return places, triangles[area > 0.0]


def _must_be_closed(triangles: Ints) -> None:
    """Raise ValueError unless every edge belongs to two triangles with opposite directions along it."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    largest = int(triangles.max(initial=0)) + 1
    there = np.sort(edges[:, 0] * largest + edges[:, 1])
    back = np.sort(edges[:, 1] * largest + edges[:, 0])
    if len(there) == 0:
        raise ValueError("its mesh has no triangle of any area")
    if (there[1:] == there[:-1]).any():
        raise ValueError("its mesh has edges with more than two triangles, or triangles that face different ways")
    open_edges = len(np.setdiff1d(there, back))
    if open_edges:
        raise ValueError(f"its mesh is open: {open_edges} edges have a triangle on one side only, so it has no inside")


def _normals(vertices: Floats, triangles: Ints) -> Floats:
    """(m, 21) unit normals of each triangle's face, edges 01, 12, 20, and vertices, the latter weighted by angle."""
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    at_vertices = np.zeros_like(vertices)
    for k in range(3):
        u = corners[:, (k + 1) % 3] - corners[:, k]
        v = corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), np.einsum("ij,ij->i", u, v))
        np.add.at(at_vertices, triangles[:, k], angle[:, None] * faces)
    ends = np.stack([np.sort(triangles[:, [k, (k + 1) % 3]], axis=1) for k in range(3)], axis=1).reshape(-1, 2)
    _, edge = np.unique(ends, axis=0, return_inverse=True)
    at_edges = np.zeros((edge.max() + 1, 3))
    np.add.at(at_edges, edge.reshape(-1), np.repeat(faces, 3, axis=0))
    return np.concatenate(
        [faces, _unit(at_edges)[edge.reshape(-1)].reshape(-1, 9), _unit(at_vertices)[triangles].reshape(-1, 9)], axis=1
    )


def _unit(vectors: Floats) -> Floats:
    units: Floats = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
    return units


def _tree(corners: Floats) -> tuple[NDArray[int64], Floats, NDArray[int64]]:
    """Order of the triangles, boxes (n, 6) in depth-first order and (n, 3) next box, first triangle, number held."""
    low, high, middle = corners.min(axis=1), corners.max(axis=1), corners.mean(axis=1)
    order = np.arange(len(corners))
    boxes: list[Floats] = []
    tree: list[list[int]] = []
    todo = [(0, len(corners), -1)]
    while todo:
        first, last, closes = todo.pop()
        if closes >= 0:  # all boxes inside this one have been laid out
            tree[closes][0] = len(boxes)
            continue
        held = order[first:last]
        node = len(boxes)
        boxes.append(np.concatenate([low[held].min(axis=0), high[held].max(axis=0)]))
        tree.append([node + 1, first, last - first])
        if last - first <= LEAF:
            continue
        tree[node][2] = 0
        axis = int(np.argmax(np.ptp(middle[held], axis=0)))
        half = (last - first) // 2
        order[first:last] = held[np.argpartition(middle[held, axis], half)]
        todo += [(0, 0, node), (first + half, last, -1), (first, first + half, -1)]
    return order, np.array(boxes), np.array(tree, dtype=np.int64)
