"""Elements with their nodes, unknowns and outer sides. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.galerkin.simplex import Simplex


@dataclass(frozen=True, slots=True, eq=False)
class FieldMesh:
    """Triangles or tetrahedra that fill a domain."""

    element: Simplex
    points: Floats
    """(n, 2 or 3) nodes [m]."""
    cells: Any
    """(e, nodes) indices into the points."""
    unknowns: Any
    """(e, nodes) which unknown stands there: nodes across periodic sides are one."""
    count: int
    """Number of unknowns."""
    faces: Any
    """(f, 2) element of each outer side, and the corner across from it."""
    pieces: Any
    """(f,) which piece of the boundary it lies on."""
    names: tuple[str, ...]
    """Those of the pieces."""
    worst: tuple[float, float]
    """The least and the largest angle [rad] of the elements: of triangles, or between faces of tetrahedra."""

    @property
    def places(self) -> Floats:
        """(count, 3) of the unknowns [m]."""
        found = np.zeros((self.count, 3))
        found[self.unknowns.ravel(), : self.points.shape[1]] = self.points[self.cells.ravel()]
        return found

    def at(self, places: Floats) -> Floats:
        """(e, q, dimension) where barycentric places (q, corners) of every element are [m]."""
        found: Floats = self.element.functions(places) @ self.points[self.cells]
        return found


def _sides(element: Simplex, corners: Floats, places: Floats) -> tuple[Floats, Floats]:
    """(e, q, d, d) dx by the barycentric coordinates after the first, and (.., q, nodes, d) slopes of the functions;
    ``places`` (q, corners), or (e, q, corners) of each element."""
    slopes = element.slopes(places)
    local = slopes[..., 1:] - slopes[..., :1]
    return np.swapaxes(corners, 1, 2)[:, None] @ local, local


def sized(element: Simplex, corners: Floats, places: Floats) -> Floats:
    """(e, q) size of elements with nodes (e, nodes, d) by that of the barycentric coordinates, [m^d]: the volume that a
    weight of 1 at a place stands for; below 0 where an element is turned."""
    sides, _ = _sides(element, corners, places)
    found: Floats = np.linalg.det(sides) / (2.0 if element.dimension == 2 else 6.0)
    return found


def gradients(element: Simplex, corners: Floats, places: Floats) -> Floats:
    """(e, q, nodes, d) gradients of the functions [1/m]."""
    sides, local = _sides(element, corners, places)
    found: Floats = local @ np.linalg.inv(sides)
    return found
