"""Solids of elements in pictures: their outer faces, or the object's own polygons, carried along. Imports numpy."""

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
"""Cells of the object's own polygons along a spacing."""
CANDIDATES, STEPS = 12, 6
"""Elements whose middles are nearest, among which that of a vertex is looked for; steps of Newton's method to its place
in a curved one."""
INSIDE, BEYOND = 1e-6, 0.3
"""Of elements in which a vertex lies it is in the middlest; how far out of an element these steps may look."""
CREASE = 0.77
"""Cosine of the largest angle [40 degrees] between triangles that are shaded as one surface."""
SIX = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
"""The triangles between the six nodes of a face."""


def triangles(mesh: ElementMesh) -> Ints:
    """(k, 3) nodes of the outer triangles, counterclockwise from outside."""
    faces = mesh.faces
    found: Ints = faces if faces.shape[1] == 3 else faces[:, SIX].reshape(-1, 3)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The outer triangles of a mesh, whose creases at rest are kept."""

    nodes: NDArray[int64]
    """(v,) the node of each vertex: one at a crease has several."""
    triangles: Ints
    """(m, 3)."""
    rest: Floats
    """(v, 3) where the material of each vertex stands at rest [m]; held."""

    @classmethod
    def of(cls, mesh: ElementMesh) -> Skin:
        """That of the material at rest."""
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
        # Sides of two triangles run opposite ways.
        rows, columns = np.concatenate([starts[one], ends[one]]), np.concatenate([ends[two], starts[two]])
        _, group = connected_components(coo_array((np.ones(len(rows)), (rows, columns)), (3 * count,) * 2), False)
        _, first, which = np.unique(group, return_index=True, return_inverse=True)
        nodes = found.ravel()[first].astype(np.int64)
        return cls(nodes, which.reshape(-1, 3).astype(np.int32), held(mesh.points[nodes]))

    def at_vertices(self, values: Floats) -> Floats:
        """(v, ...) what nodes (n, ...) have, at the vertices."""
        return values[self.nodes]

    def drawn(self, name: str, surface: Surface, places: Floats) -> Mesh:
        """The triangles where nodes are at places (n, 3) [m], smooth but for creases."""
        own = places[self.nodes]
        return Mesh(name, surface, own, self.triangles, vertex_normals(own, self.triangles), rest=self.rest)


@dataclass(frozen=True, slots=True, eq=False)
class Carried:
    """Polygons whose vertices follow the elements that they lie in."""

    triangles: Ints
    """(m, 3)."""
    nodes: Ints
    """(v, k) nodes of each vertex's element."""
    weights: Floats
    """(v, k) its functions there."""
    gradients: Floats
    """(v, k, 3) and their gradients [1/m]."""
    normals: Floats
    """(v, 3) of the polygons at rest; on a crease stand several vertices."""
    rest: Floats
    """(v, 3) the vertices at rest [m]; held."""

    def at_vertices(self, values: Floats) -> Floats:
        """(v, ...) what nodes (n, ...) have, at the vertices: within what those of their elements have."""
        return within_elements(values[self.nodes], self.weights)

    def drawn(self, name: str, surface: Surface, places: Floats) -> Mesh:
        """The polygons where nodes are at places (n, 3) [m]."""
        nodes = places[self.nodes]
        vertices = np.einsum("vk,vki->vi", self.weights, nodes)
        f = np.einsum("vki,vkj->vij", nodes, self.gradients)
        columns = [np.cross(f[:, :, (j + 1) % 3], f[:, :, (j + 2) % 3]) for j in range(3)]
        normals = np.einsum("vij,vj->vi", np.stack(columns, axis=2), self.normals)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, where=length > 0, out=normals)
        return Mesh(name, surface, vertices, self.triangles, normals, rest=self.rest)


def within_elements(values: Floats, weights: Floats) -> Floats:
    """(v, ...) by nodes (v, k, ...) and their functions (v, k): no less and no more than at the nodes of an element."""
    found = np.einsum("vk,vk...->v...", weights, values)
    clipped: Floats = np.clip(found, values.min(axis=1), values.max(axis=1))
    return clipped


@dataclass(frozen=True, slots=True, eq=False)
class Inside:
    """The elements of a solid at an instant, for what is seen of its inside."""

    mesh: ElementMesh
    """At rest."""
    places: Floats
    """(n, 3) its nodes in the drawing."""
    values: Floats | None
    """(n,) what is shown of them."""

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Places of the material (k, 3) at points (k, 3) of the drawing, and what is shown there (k, 1), or (k, 0)."""
        nodes, weights, _ = in_elements(replace(self.mesh, points=self.places), points)
        rest = np.einsum("vk,vki->vi", weights, self.mesh.points[nodes])
        if self.values is None:
            return rest, np.empty((len(points), 0))
        return rest, within_elements(self.values[nodes], weights)[:, None]


def carried(ref: Ref, spacing: float, mesh: ElementMesh, assembly: Assembly) -> Carried:
    """The polygons of an object at the start of the run, as elements of its material carry them."""
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
    smooth = np.einsum("vi,vi->v", found.normals[source], normals) > CREASE  # at creases the field has no slope
    normals[smooth] = found.normals[source[smooth]]
    return vertices, triangles, normals


def in_elements(mesh: ElementMesh, vertices: Floats) -> tuple[Ints, Floats, Floats]:
    """Of the element in which each vertex (v, 3) lies nodes (v, k), functions there (v, k), their gradients (v, k, 3).

    A vertex outside of all elements is carried by the nearest, as if this went on from its nearest place without any
    more change of its strain: its functions, which are squares, grow too large not far outside.
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
    """Barycentric places (..., 4) of an element near those given, which may lie outside."""
    inner = np.maximum(at, 0.0)
    found: Floats = inner / inner.sum(axis=-1, keepdims=True)
    return found


def _sides(mesh: ElementMesh, at: Floats, nodes: Floats) -> Floats:
    """(v, 3, 3) slopes of places by barycentric coordinates (v, 4) in elements with nodes (v, k, 3)."""
    slopes = mesh.element.slopes(at)
    found: Floats = np.einsum("vki,vkj->vij", nodes, slopes[:, :, 1:] - slopes[:, :, :1])
    return found
