"""A field on elements between its nodes: the elements of places, and its values there. Imports numpy."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.grids.maps.kept import Kept

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.galerkin.field_mesh import FieldMesh
    from sceneql.grids.medium import FieldLayout

NEAREST = 12
"""Elements with the nearest centers among which that of a place is looked for."""
FEWER = 4
"""Those among which it is looked for first."""
INVERSIONS = 6
"""Most steps of Newton's method to a place in an element with curved sides."""
BEYOND = 0.5
"""How far outside its element, in barycentric coordinates, a field is continued; beyond it stays."""

FARTHEST = 1.0
"""Farthest, in barycentric coordinates from its middle, that an element's own functions tell where a place is."""
LEAST = 0.1
"""Part of an element's straight size below which it is taken as straight at a place, far outside of it."""


class BetweenNodes:
    """The functions of a mesh's elements as pictures read them (grids.medium.Between)."""

    what = "nodes"

    def __init__(self, mesh: FieldMesh, layout: FieldLayout) -> None:
        """``layout``: the grid on which pictures see a deep field."""
        self.mesh, self.layout, self.count = mesh, layout, mesh.count
        self._weights: Kept[Any] = Kept()

    def filled(self, values: Floats) -> Floats:
        """The values at the nodes themselves."""
        return values

    def at(self, field: Floats, points: Floats) -> Floats:
        """The field (k,) at points (k, 3) [m]; a little outside the elements it is continued."""
        found: Floats = self._weights.get(points, None, lambda: self.weights(points)[0]) @ field
        return found

    def gridded(self, field: Floats) -> Floats:
        """(nz, ny, nx) at the centers of the cells of the layout, with a layer of cells around them of a deep one."""
        weights, _ = self._grid
        found: Floats = (weights @ field).reshape(self.shape)
        return found

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of `gridded`."""
        nx, ny, nz = self.layout.shape
        return (nz if nz == 1 else nz + 2, ny + 2, nx + 2)

    @property
    def known(self) -> Any:
        """Which of these centers lie in elements."""
        return self._grid[1].reshape(self.shape)

    @cached_property
    def _grid(self) -> tuple[Any, Any]:
        k, j, i = (index.ravel() for index in np.indices(self.shape))
        first = 0.0 if self.layout.shape[2] > 1 else 0.5
        index = np.stack([i - 0.5, j - 0.5, k - 0.5 + first], axis=1)
        return self.weights(np.array(self.layout.low) + index * np.array(self.layout.spacing))

    def weights(self, points: Floats) -> tuple[Any, Any]:
        """Sparse (k, count) weights of the nodes at points (k, 3), and which points (k,) lie in elements."""
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
        """Which points (k, 3) lie in elements, or as little outside as a field is continued: (k,)."""
        return (self._located(points[:, : self.mesh.element.dimension])[1] > -BEYOND).all(axis=1)

    def _located(self, points: Floats) -> tuple[Any, Floats]:
        """Elements (k,) of points (k, d), or those that they are least outside of, and barycentric places there."""
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
        """(k, corners) barycentric places of points (k, d) in elements (k,)."""
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
