"""Surfaces of element meshes in pictures: the outer faces, or the object's own polygons, deformed with the elements.

Imports numpy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.spring_look import vertex_normals
from sceneql.frame import Mesh, Surface, held

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.frame import Floats, Ints
    from sceneql.kinds import Ref
    from sceneql.system import Assembly

CELLS = 3
"""Cells of the object's polygonization along a spacing of the elements."""
CANDIDATES, STEPS = 12, 6
"""Elements, those with the nearest centers, among which the one of a vertex is searched; Newton steps to the vertex's
barycentric coordinates in a curved element."""
INSIDE, BEYOND = 1e-6, 0.3
"""Bonus, relative to an element's size, for being far inside, which decides between elements that contain a vertex;
largest distance outside an element, in barycentric coordinates, of Newton's iterates."""
CREASE = 0.77
"""Cosine of 40 degrees, the largest angle between triangles that are shaded as one smooth surface."""
SIX = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
"""The triangles that a face with six nodes is drawn by."""


def triangles(mesh: ElementMesh) -> Ints:
    """Nodes (k, 3) of the triangles of the outer faces, counterclockwise from outside."""
    faces = mesh.faces
    found: Ints = faces if faces.shape[1] == 3 else faces[:, SIX].reshape(-1, 3)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The outer triangles of a mesh, with separate vertices on the sides of creases at rest."""

    nodes: NDArray[int64]
    """(v,) the node of each vertex; a node on a crease has several vertices."""
    triangles: Ints
    """(m, 3)."""
    rest: Floats
    """(v, 3) [m] rest positions of the vertices; held (frame.held)."""

    @classmethod
    def of(cls, mesh: ElementMesh) -> Skin:
        """The skin of a mesh, with creases found at rest."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        found = triangles(mesh)
        a, b, c = (mesh.points[found[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        count = len(found)
        sides = np.concatenate([found[:, [0, 1]], found[:, [1, 2]], found[:, [2, 0]]]).astype(np.int64)
        starts = np.concatenate([3 * np.arange(count) + k for k in range(3)])
        ends = np.concatenate([3 * np.arange(count) + (k + 1) % 3 for k in range(3)])
        low, high = sides.min(axis=1), sides.max(axis=1)
        order = np.lexsort((sides[:, 0] != low, high, low))
        pairs = np.flatnonzero((low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1]))
        one, two = order[pairs], order[pairs + 1]
        flat = np.sum(normals[one % count] * normals[two % count], axis=1) > CREASE
        one, two = one[flat], two[flat]
        # Two triangles have their common side in opposite directions.
        rows, columns = np.concatenate([starts[one], ends[one]]), np.concatenate([ends[two], starts[two]])
        _, group = connected_components(coo_array((np.ones(len(rows)), (rows, columns)), (3 * count,) * 2), False)
        _, first, which = np.unique(group, return_index=True, return_inverse=True)
        nodes = found.ravel()[first].astype(np.int64)
        return cls(nodes, which.reshape(-1, 3).astype(np.int32), held(mesh.points[nodes]))

    def at_vertices(self, values: Floats) -> Floats:
        """Values (v, ...) at the vertices, from values (n, ...) at the nodes."""
        return values[self.nodes]

    def drawn(self, name: str, surface: Surface, places: Floats) -> Mesh:
        """The mesh for nodes at ``places`` (n, 3) [m], with normals that are smooth except across creases."""
        own = places[self.nodes]
        return Mesh(name, surface, own, self.triangles, vertex_normals(own, self.triangles), rest=self.rest)


@dataclass(frozen=True, slots=True, eq=False)
class Carried:
    """Polygons whose vertices move with the elements that contain them."""

    triangles: Ints
    """(m, 3)."""
    nodes: Ints
    """(v, k) nodes of each vertex's element."""
    weights: Floats
    """(v, k) shape functions of the element at the vertex."""
    gradients: Floats
    """(v, k, 3) [1/m] gradients of the shape functions there."""
    normals: Floats
    """(v, 3) unit normals at rest; a point on a crease has several vertices."""
    rest: Floats
    """(v, 3) [m] rest positions; held (frame.held)."""

    def at_vertices(self, values: Floats) -> Floats:
        """Values (v, ...) at the vertices, from values (n, ...) at the nodes, clipped to the range in the element."""
        return within_elements(values[self.nodes], self.weights)

    def drawn(self, name: str, surface: Surface, places: Floats) -> Mesh:
        """The mesh for nodes at ``places`` (n, 3) [m]; normals transformed by the cofactors of F."""
        nodes = places[self.nodes]
        vertices = np.einsum("vk,vki->vi", self.weights, nodes)
        f = np.einsum("vki,vkj->vij", nodes, self.gradients)
        columns = [np.cross(f[:, :, (j + 1) % 3], f[:, :, (j + 2) % 3]) for j in range(3)]
        normals = np.einsum("vij,vj->vi", np.stack(columns, axis=2), self.normals)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, where=length > 0, out=normals)
        return Mesh(name, surface, vertices, self.triangles, normals, rest=self.rest)


def within_elements(values: Floats, weights: Floats) -> Floats:
    """Interpolated values (v, ...) from nodes (v, k, ...) by shape functions (v, k), clipped to the nodes' range."""
    found = np.einsum("vk,vk...->v...", weights, values)
    clipped: Floats = np.clip(found, values.min(axis=1), values.max(axis=1))
    return clipped


@dataclass(frozen=True, slots=True, eq=False)
class Inside:
    """The elements of a solid at an instant, for points inside it that a cut makes visible."""

    mesh: ElementMesh
    """The mesh at rest."""
    places: Floats
    """(n, 3) [m] deformed positions of its nodes, as drawn."""
    values: Floats | None
    """(n,) values shown by color at the nodes, if any."""

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Rest positions (k, 3) [m] of drawn points (k, 3), and the values shown there (k, 1), or (k, 0)."""
        nodes, weights, _ = in_elements(replace(self.mesh, points=self.places), points)
        rest = np.einsum("vk,vki->vi", weights, self.mesh.points[nodes])
        if self.values is None:
            return rest, np.empty((len(points), 0))
        return rest, within_elements(self.values[nodes], weights)[:, None]


def carried(ref: Ref, spacing: float, mesh: ElementMesh, assembly: Assembly) -> Carried:
    """The polygons of an object at the start of the run, attached to the elements of ``mesh``."""
    vertices, triangles, normals = _polygons(ref, spacing, assembly)
    return Carried(triangles, *in_elements(mesh, vertices), normals, held(vertices))


def _polygons(ref: Ref, spacing: float, assembly: Assembly) -> tuple[Floats, Ints, Floats]:
    """Vertices (v, 3), triangles (m, 3) and normals (v, 3), with a vertex for each side of a crease."""
    from scipy.spatial import cKDTree

    from sceneql.bodies.filling.fill import Inside
    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.island.start import Start
    from sceneql.mesh.dual.sharp import polygonise_sharp
    from sceneql.shapes.creases import creased
    from sceneql.shapes.raw_mesh import RawMesh

    kind: Any = assembly.object(ref)
    start: Any = Start(assembly)
    corners = getattr(kind, "triangles_at", None)
    if corners is not None:
        places = corners(start).reshape(-1, 3)
        raw = RawMesh(places, np.arange(len(places), dtype=np.int32).reshape(-1, 3), None)
        return creased(raw, np.arccos(CREASE))[:3]
    box = Inside(ref, assembly)
    build = TapeBuilder()
    tape = build.finish(kind.implicit(build, build.x, build.y, build.z, start))
    cell = spacing / CELLS
    low, high = ((float(x), float(y), float(z)) for x, y, z in (box.low - cell, box.high + cell))
    found = polygonise_sharp(tape, low, high, cell)
    vertices, triangles, normals, _ = creased(RawMesh(found.vertices, found.triangles, None), np.arccos(CREASE))
    _, source = cKDTree(found.vertices).query(vertices)
    smooth = np.einsum("vi,vi->v", found.normals[source], normals) > CREASE  # at creases the field has no gradient
    normals[smooth] = found.normals[source[smooth]]
    return vertices, triangles, normals


def in_elements(mesh: ElementMesh, vertices: Floats) -> tuple[Ints, Floats, Floats]:
    """Nodes (v, k), shape functions (v, k) and their gradients (v, k, 3) of the element that contains each vertex.

    A vertex outside all elements belongs to the nearest one, extrapolated linearly from the nearest point of it:
    quadratic shape functions grow too large not far outside.
    """
    from scipy.spatial import cKDTree

    corners = mesh.points[mesh.cells[:, :4]]
    inverse = np.linalg.pinv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    _, near = cKDTree(corners.mean(axis=1)).query(vertices, k=min(CANDIDATES, len(corners)))
    near = near.reshape(len(vertices), -1)
    own = np.einsum("vcij,vcj->vci", inverse[near], vertices[:, None] - corners[near, 0])
    own = np.concatenate([1.0 - own.sum(axis=2, keepdims=True), own], axis=2)
    nearest = _inward(own)
    away = np.linalg.norm(np.einsum("vck,vcki->vci", nearest, corners[near]) - vertices[:, None], axis=2)
    size = np.ptp(corners, axis=1).max()
    best = (away - INSIDE * size * np.minimum(own.min(axis=2), 1.0)).argmin(axis=1)
    rows = np.arange(len(vertices))
    cell, at = near[rows, best], nearest[rows, best]
    nodes = mesh.points[mesh.cells[cell]]
    for _ in range(STEPS if mesh.element.edges else 0):
        away = vertices - np.einsum("vk,vki->vi", mesh.element.functions(at), nodes)
        step = np.einsum("vij,vj->vi", np.linalg.pinv(_sides(mesh, at, nodes)), away)
        at = np.clip(at + np.concatenate([-step.sum(axis=1, keepdims=True), step], axis=1), -BEYOND, 1.0 + BEYOND)
    at = _inward(at)
    slopes = mesh.element.slopes(at)
    gradients = (slopes[:, :, 1:] - slopes[:, :, :1]) @ np.linalg.pinv(_sides(mesh, at, nodes))
    functions = mesh.element.functions(at)
    away = vertices - np.einsum("vk,vki->vi", functions, nodes)
    return mesh.cells[cell], functions + np.einsum("vki,vi->vk", gradients, away), gradients


def _inward(at: Floats) -> Floats:
    """Barycentric coordinates (..., 4) moved into the element: negative ones set to 0, then scaled to sum 1."""
    inner = np.maximum(at, 0.0)
    found: Floats = inner / inner.sum(axis=-1, keepdims=True)
    return found


def _sides(mesh: ElementMesh, at: Floats, nodes: Floats) -> Floats:
    """Jacobians (v, 3, 3) of positions by three barycentric coordinates, at points (v, 4) of elements (v, k, 3)."""
    slopes = mesh.element.slopes(at)
    found: Floats = np.einsum("vki,vkj->vij", nodes, slopes[:, :, 1:] - slopes[:, :, :1])
    return found
