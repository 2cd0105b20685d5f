"""Integrals over elements and outer sides: masses, stiffness matrices, Nitsche terms. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.galerkin.field_mesh import FieldMesh, gradients, sized

if TYPE_CHECKING:
    from sceneql.frame import Floats

CHUNK = 20_000
"""Number of elements integrated at a time."""
FIRM = 2.0
"""Nitsche penalty of given values, relative to the least one that keeps the matrix positive."""


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """Quadrature points of outer sides: q on each of f sides."""

    owners: Any
    """(f,): element of each side."""
    points: Floats
    """(f, q, 3) [m]."""
    weights: Floats
    """(f, q) [m^2]: areas of the points."""
    functions: Floats
    """(f, q, nodes): values of the element's functions."""
    normal: Floats
    """(f, q, nodes) [1/m]: outward normal derivatives of the functions."""
    steep: Floats
    """(f,) [1/m]: Simplex.steepness times the side's area over the element's volume."""


class WeakForm:
    """Integrals of a mesh.

    ``depth`` [m]: thickness of a flat mesh; ``rule``: quadrature points and weights, by default the element's own.
    """

    def __init__(self, mesh: FieldMesh, depth: float, rule: tuple[Floats, Floats] | None = None) -> None:
        self.mesh, self.rule = mesh, mesh.element.rule if rule is None else rule
        self.depth = depth if mesh.element.dimension == 2 else 1.0

    @cached_property
    def weights(self) -> Floats:
        """Volumes (e, q) [m^3] of the quadrature points."""
        mesh = self.mesh
        places, weights = self.rule
        found: Floats = sized(mesh.element, mesh.points[mesh.cells], places) * weights * self.depth
        return found

    @cached_property
    def points(self) -> Floats:
        """Quadrature points (e, q, 3) [m]."""
        at = self.mesh.at(self.rule[0])
        found = np.zeros((*at.shape[:2], 3))
        found[..., : at.shape[2]] = at
        return found

    @property
    def functions(self) -> Floats:
        """Values (q, nodes) of the functions at the quadrature points."""
        return self.mesh.element.functions(self.rule[0])

    def gradients(self, chosen: Any = slice(None)) -> Floats:
        """Gradients (e, q, nodes, d) [1/m] of the functions at the quadrature points of chosen elements."""
        mesh = self.mesh
        return gradients(mesh.element, mesh.points[mesh.cells[chosen]], self.rule[0])

    @cached_property
    def volumes(self) -> Floats:
        """Integrals (unknowns,) [m^3] of the functions."""
        found = np.zeros(self.mesh.count)
        np.add.at(found, self.mesh.unknowns, self.weights @ self.functions)
        return found

    def mass(self) -> Any:
        """Mass matrix (unknowns, unknowns) [m^3], sparse: integrals of products of functions; lumped for degree 1."""
        from scipy.sparse import diags_array

        if self.mesh.element.degree == 1:
            return diags_array(self.volumes).tocsr()
        shapes = self.functions
        products = (shapes[:, :, None] * shapes[:, None, :]).reshape(len(shapes), -1)
        return self.gathered(self.weights @ products)

    def stiffness(self, coefficient: Floats) -> Any:
        """Sparse stiffness matrix (unknowns, unknowns) [m^3/s]; ``coefficient`` (e, q) [m^2/s] at quadrature points."""
        held = self.weights * coefficient
        parts = []
        for first in range(0, len(held), CHUNK):
            chosen = slice(first, first + CHUNK)
            slopes = self.gradients(chosen)
            if self.mesh.element.degree == 1:
                parts.append(held[chosen].sum(axis=1)[:, None, None] * (slopes[:, 0] @ slopes[:, 0].swapaxes(1, 2)))
            else:
                parts.append(np.einsum("eq,eqia,eqja->eij", held[chosen], slopes, slopes, optimize=True))
        return self.gathered(np.concatenate(parts))

    def gathered(self, blocks: Floats, owners: Any = slice(None)) -> Any:
        """Sparse sum (unknowns, unknowns) of element matrices (e, nodes, nodes) of elements ``owners``."""
        from scipy.sparse import coo_array

        unknowns = self.mesh.unknowns[owners]
        k = unknowns.shape[1]
        rows, columns = np.repeat(unknowns, k, axis=1).ravel(), np.tile(unknowns, (1, k)).ravel()
        found = coo_array((blocks.ravel(), (rows, columns)), shape=(self.mesh.count,) * 2).tocsr()
        found.sort_indices()
        return found

    def edge(self, faces: Any) -> Edge:
        """Quadrature points of outer sides ``faces`` (f,), indices into the mesh's faces."""
        mesh, element = self.mesh, self.mesh.element
        owners, across = mesh.faces[faces].T if len(faces) else np.zeros((2, 0), dtype=np.int64)
        places, weights = element.side_rule()
        at = places[across]
        corners = mesh.points[mesh.cells[owners]]
        slopes = element.slopes(at)
        ends = np.array(element.sides)[across]
        own = np.arange(len(owners))[:, None]
        along = [slopes[own, :, :, ends[:, [k]]] - slopes[own, :, :, ends[:, [0]]] for k in range(1, element.dimension)]
        ways = [np.einsum("fqn,fnd->fqd", way[:, 0], corners) for way in along]
        if element.dimension == 2:
            across_side = np.stack([ways[0][..., 1], -ways[0][..., 0]], axis=-1)
        else:
            across_side = 0.5 * np.cross(ways[0], ways[1])
        area = np.linalg.norm(across_side, axis=-1)
        outward = across_side / area[..., None]
        functions = element.functions(at)
        normal = np.einsum("fqnd,fqd->fqn", gradients(element, corners, at), outward)
        points = np.zeros((*at.shape[:2], 3))
        points[..., : element.dimension] = np.einsum("fqn,fnd->fqd", functions, corners)
        volume = self.weights[owners].sum(axis=1)
        held = area * weights * self.depth
        return Edge(owners, points, held, functions, normal, element.steepness * held.sum(axis=1) / volume)


def firmness(edge: Edge) -> Floats:
    """Nitsche penalty (f,) [1/m] of sides with given values, from the sum over such sides of each element."""
    found = np.zeros(int(edge.owners.max(initial=-1)) + 1)
    np.add.at(found, edge.owners, edge.steep)
    strength: Floats = FIRM * found[edge.owners]
    return strength
