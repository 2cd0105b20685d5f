"""The surface of a tetrahedral mesh: outer faces and edges, and which vertices may move along it. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.elements.element_mesh import unit
from sceneql.bodies.filling.tetrahedra import FACES, boundary

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats

STRAIGHT = 1e-10
"""One less the cosine up to which two planes, or the two parts of an edge, count as one."""


@dataclass(frozen=True, slots=True, eq=False)
class Outer:
    """Outer faces and edges of tetrahedra."""

    faces: Any
    """(f, 3) counterclockwise from outside."""
    across: Floats
    """(f, 3) unit normals of the faces."""
    ends: Any
    """(e, 2) outer edges with two faces each, the lower end first."""
    beside: Any
    """(e, 2) their faces."""
    sharp: NDArray[bool_]
    """(e,) whether the faces' normals differ."""
    sides: Floats
    """(e, 2, 3) unit directions from the edge into its two faces."""
    free: NDArray[bool_]
    """(n,) outer vertices that may move along all faces around them, since these are one surface."""
    along: NDArray[bool_]
    """(n,) those that may move along the two sharp edges that meet in them."""

    @classmethod
    def of(cls, points: Floats, cells: Any, cosine: float | None) -> Outer:
        """The surface of tetrahedra (t, 4); normals of an angle with less than ``cosine`` differ.

        ``cosine`` None: no vertex may leave the planes and straight edges on which it is.
        """
        faces = boundary(cells).astype(np.int64)
        a, b, c = (points[faces[:, k]] for k in range(3))
        across = unit(np.cross(b - a, c - a))
        size, count = len(points), len(faces)
        ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        tips = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
        keys, which, many = np.unique(ends @ (size, 1), return_inverse=True, return_counts=True)
        order = np.argsort(which, kind="stable")
        pairs = order[(many == 2)[which[order]]].reshape(-1, 2)
        fixed = np.zeros(size, dtype=bool)  # where parts touch along an edge
        fixed[np.concatenate(np.divmod(keys[many != 2], size))] = True
        beside, sides = pairs % count, points[tips[pairs]] - points[ends[pairs[:, 0], 0]][:, None]
        ends = ends[pairs[:, 0]]
        way = unit(points[ends[:, 1]] - points[ends[:, 0]])
        sides = unit(sides - np.einsum("kji,ki->kj", sides, way)[..., None] * way[:, None])
        one, two = across[beside[:, 0]], across[beside[:, 1]]
        sharp = np.einsum("ki,ki->k", one, two) < (1.0 - STRAIGHT if cosine is None else cosine)
        met, pull = np.bincount(ends[sharp].ravel(), minlength=size), np.zeros((size, 3))
        np.add.at(pull, ends[sharp, 0], way[sharp])
        np.subtract.at(pull, ends[sharp, 1], way[sharp])
        outer = np.bincount(faces.ravel(), minlength=size) > 0
        along = outer & ~fixed & (met == 2)
        if cosine is None:
            along &= np.einsum("ni,ni->n", pull, pull) < STRAIGHT
        return cls(faces, across, ends, beside, sharp, sides, outer & ~fixed & (met == 0), along)

    def owners(self, cells: Any) -> Any:
        """(f,) a tetrahedron of each face."""
        size = int(cells.max()) + 1

        def keys(faces: Any) -> Any:
            low, middle, high = np.sort(faces, axis=1).T
            return (low * size + middle) * size + high

        all_of = keys(cells[:, FACES].reshape(-1, 3).astype(np.int64))
        order = np.argsort(all_of, kind="stable")
        return order[np.searchsorted(all_of[order], keys(self.faces))] // len(FACES)
