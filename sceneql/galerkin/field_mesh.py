"""Mesh of elements with nodes, unknowns and outer sides. Imports numpy."""

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
    """(n, 2 or 3) [m]: nodes."""
    cells: Any
    """(e, nodes): indices into the points."""
    unknowns: Any
    """(e, nodes): index of the unknown at each node; opposite nodes of periodic sides share one."""
    count: int
    """Number of unknowns."""
    faces: Any
    """(f, 2): element of each outer side, and its corner opposite to that side."""
    pieces: Any
    """(f,): index of the boundary piece of each outer side."""
    names: tuple[str, ...]
    """Names of the pieces."""

    @property
    def worst(self) -> tuple[float, float]:
        """Least and largest angle [rad]: of triangles, or between faces of tetrahedra."""
        from sceneql.bodies.elements.element_mesh import worst_angle
        from sceneql.galerkin.plane_quality import angles

        found = angles if self.element.dimension == 2 else worst_angle
        return found(self.points, self.cells[:, : self.element.dimension + 1])

    @property
    def places(self) -> Floats:
        """Positions (count, 3) [m] of the unknowns."""
        found = np.zeros((self.count, 3))
        found[self.unknowns.ravel(), : self.points.shape[1]] = self.points[self.cells.ravel()]
        return found

    def at(self, places: Floats) -> Floats:
        """Positions (e, q, dimension) [m] of barycentric coordinates (q, corners) in every element."""
        found: Floats = self.element.functions(places) @ self.points[self.cells]
        return found


def _sides(element: Simplex, corners: Floats, places: Floats) -> tuple[Floats, Floats]:
    """Jacobian (e, q, d, d) [m] by the barycentric coordinates after the first, and derivatives (.., q, nodes, d) of
    the functions by them; ``places``: barycentric, (q, corners) or (e, q, corners). Degree 1: q = 1, for all places."""
    slopes = element.slopes(places[..., :1, :] if element.degree == 1 else places)
    local = slopes[..., 1:] - slopes[..., :1]
    return np.swapaxes(corners, 1, 2)[:, None] @ local, local


def sized(element: Simplex, corners: Floats, places: Floats) -> Floats:
    """Volume (e, q) [m^d] per unit of quadrature weight in elements with nodes (e, nodes, d) at barycentric ``places``.

    Negative in an inverted element.
    """
    sides, _ = _sides(element, corners, places)
    found: Floats = np.linalg.det(sides) / (2.0 if element.dimension == 2 else 6.0)
    return np.broadcast_to(found, (len(corners), places.shape[-2]))


def gradients(element: Simplex, corners: Floats, places: Floats) -> Floats:
    """Gradients (e, q, nodes, d) [1/m] of the functions at barycentric ``places``."""
    sides, local = _sides(element, corners, places)
    found: Floats = local @ np.linalg.inv(sides)
    return np.broadcast_to(found, (len(corners), places.shape[-2], *found.shape[2:]))
