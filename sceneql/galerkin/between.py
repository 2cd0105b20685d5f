"""Interpolation of a field on elements: the element that contains a point, and the field there. Imports numpy."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.galerkin.field_mesh import FieldMesh
from sceneql.galerkin.simplex import Simplex
from sceneql.grids.maps.kept import Kept

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout

NEAREST = 12
"""Number of elements with the nearest centers that are searched for a point."""
FEWER = 4
"""Number of elements that are searched first."""
INVERSIONS = 6
"""Largest number of Newton steps for a point in an element with curved sides."""
BEYOND = 0.5
"""Distance outside its element, in barycentric coordinates, up to which a field is continued; constant beyond."""

FARTHEST = 1.0
"""Largest barycentric distance from an element's middle at which its curved map is used."""
LEAST = 0.1
"""Fraction of the straight element's Jacobian below which the straight map replaces the curved one."""


def within(mesh: ElementMesh, values: Floats) -> Callable[[Floats], Floats]:
    """The function of places (k, 3) [m] that has ``values`` (n, ...) at the nodes of a solid."""
    element, count = Simplex(3, 2 if mesh.element.edges else 1), len(mesh.points)
    own = FieldMesh(element, mesh.points, mesh.cells, mesh.cells, count, (), (), ())
    between = BetweenNodes(own, None)
    return lambda places: between.weights(places)[0] @ values


class BetweenNodes:
    """Interpolation of a field on a mesh for pictures (implements grids.medium.Between)."""

    what = "nodes"

    def __init__(self, mesh: FieldMesh, layout: FieldLayout | None) -> None:
        """``layout``: grid on which pictures sample a deep field; None where there are no pictures."""
        self.mesh, self.count = mesh, mesh.count
        self.layout: Any = layout
        self._weights: Kept[Any] = Kept()

    def filled(self, values: Floats) -> Floats:
        """Values at the nodes, unchanged."""
        return values

    def at(self, field: Floats, points: Floats) -> Floats:
        """Field (k,) at points (k, 3) [m]; continued a little outside the elements."""
        found: Floats = self._weights.get(points, None, lambda: self.weights(points)[0]) @ field
        return found

    def gridded(self, field: Floats) -> Floats:
        """Field (nz, ny, nx) at centers of the layout's cells, with one layer of cells around them (z: if deep)."""
        weights, _ = self._grid
        found: Floats = (weights @ field).reshape(self.shape)
        return found

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape (nz, ny, nx) of `gridded`."""
        nx, ny, nz = self.layout.shape
        return (nz if nz == 1 else nz + 2, ny + 2, nx + 2)

    @property
    def known(self) -> Any:
        """Mask (nz, ny, nx) of the centers of `gridded` that lie in elements."""
        return self._grid[1].reshape(self.shape)

    @cached_property
    def _grid(self) -> tuple[Any, Any]:
        k, j, i = (index.ravel() for index in np.indices(self.shape))
        first = 0.0 if self.layout.shape[2] > 1 else 0.5
        index = np.stack([i - 0.5, j - 0.5, k - 0.5 + first], axis=1)
        return self.weights(np.array(self.layout.low) + index * np.array(self.layout.spacing))

    def weights(self, points: Floats) -> tuple[Any, Any]:
        """Sparse weights (k, count) of the nodes at points (k, 3) [m], and mask (k,) of the points in elements."""
        from scipy.sparse import csr_array

        mesh, element = self.mesh, self.mesh.element
        owner, places = self._located(points[:, : element.dimension])
        inside = (places > -1e-9).all(axis=1)
        places = np.maximum(places, -BEYOND)
        places /= places.sum(axis=1, keepdims=True)
        shapes = element.functions(places)
        starts = np.arange(len(points) + 1) * element.nodes
        return csr_array((shapes.ravel(), mesh.unknowns[owner].ravel(), starts), (len(points), mesh.count)), inside

    def beside(self, points: Floats) -> Any:
        """Mask (k,) of points (k, 3) [m] in elements, or less than BEYOND outside one."""
        return (self._located(points[:, : self.mesh.element.dimension])[1] > -BEYOND).all(axis=1)

    def _located(self, points: Floats) -> tuple[Any, Floats]:
        """Elements (k,) that contain points (k, d), or are nearest, and the points' barycentric coordinates there."""
        owner = np.zeros(len(points), dtype=np.int64)
        places = np.full((len(points), self.mesh.element.dimension + 1), -np.inf)
        left = np.arange(len(points))
        for count in (FEWER, NEAREST):
            if not len(left):
                break
            _, near = self._tree.query(points[left], k=min(count, len(self.mesh.cells)))
            for one in near.reshape(len(left), -1).T:
                found = self._places(one, points[left])
                better = found.min(axis=1) > places[left].min(axis=1) + 1e-12
                owner[left[better]], places[left[better]] = one[better], found[better]
            left = left[places[left].min(axis=1) < -1e-9]
        return owner, places

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        corners = self.mesh.points[self.mesh.cells[:, : self.mesh.element.dimension + 1]]
        return cKDTree(corners.mean(axis=1))

    def _places(self, owner: Any, points: Floats) -> Floats:
        """Barycentric coordinates (k, corners) of points (k, d) in elements (k,)."""
        element = self.mesh.element
        nodes = self.mesh.points[self.mesh.cells[owner]]
        corners = nodes[:, : element.dimension + 1]
        sides = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        local = np.linalg.solve(sides, (points - corners[:, 0])[..., None])[..., 0]
        places = np.concatenate([1.0 - local.sum(axis=1, keepdims=True), local], axis=1)
        size, middle = np.abs(sides).max(), 1.0 / (element.dimension + 1)
        for _ in range(INVERSIONS if element.degree == 2 else 0):
            away = places - middle
            at = middle + away * np.minimum(1.0, FARTHEST / np.maximum(np.abs(away).max(axis=1, keepdims=True), 1e-300))
            away = points - np.einsum("kn,knd->kd", element.functions(at), nodes)
            if np.abs(away).max(initial=0.0) < 1e-14 * size and (at == places).all():
                break
            slopes = element.slopes(at)
            turned = np.swapaxes(nodes, 1, 2) @ (slopes[..., 1:] - slopes[..., :1])
            flat = np.abs(np.linalg.det(turned)) < LEAST * np.abs(np.linalg.det(sides))
            turned = np.where(flat[:, None, None], sides, turned)
            local = np.linalg.solve(turned, away[..., None])[..., 0]
            places = at + np.concatenate([-local.sum(axis=1, keepdims=True), local], axis=1)
        return places
