"""Solids of elements in pictures: their outer faces, or the object's own polygons, carried along. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.spring_look import vertex_normals
from sceneql.frame import Mesh, Surface

if TYPE_CHECKING:
    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.frame import Floats, Ints
    from sceneql.kinds import Ref
    from sceneql.system import Assembly

CELLS = 3
"""Cells of the object's own polygons along a spacing."""
CANDIDATES, STEPS = 12, 6
"""Elements whose middles are nearest, among which that of a vertex is looked for; steps of Newton's method to its place
in a curved one."""
SIX = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
"""The triangles between the six nodes of a face."""


def triangles(mesh: ElementMesh) -> Ints:
    """(k, 3) nodes of the outer triangles, counterclockwise from outside."""
    faces = mesh.faces
    found: Ints = faces if faces.shape[1] == 3 else faces[:, SIX].reshape(-1, 3)
    return found


def skin(name: str, surface: Surface, mesh: ElementMesh, places: Floats) -> Mesh:
    """The outer triangles of nodes at places (n, 3) [m], smooth."""
    found = triangles(mesh)
    used, which = np.unique(found, return_inverse=True)
    own, corners = places[used], which.reshape(-1, 3).astype(np.int32)
    return Mesh(name, surface, own, corners, vertex_normals(own, corners))


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
    normals: Floats | None
    """(v, 3) of the polygons at rest; None: those of the triangles around."""

    def drawn(self, name: str, surface: Surface, places: Floats) -> Mesh:
        """The polygons where nodes are at places (n, 3) [m]."""
        nodes = places[self.nodes]
        vertices = np.einsum("vk,vki->vi", self.weights, nodes)
        if self.normals is None:
            return Mesh(name, surface, vertices, self.triangles, vertex_normals(vertices, self.triangles))
        f = np.einsum("vki,vkj->vij", nodes, self.gradients)
        columns = [np.cross(f[:, :, (j + 1) % 3], f[:, :, (j + 2) % 3]) for j in range(3)]
        normals = np.einsum("vij,vj->vi", np.stack(columns, axis=2), self.normals)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        return Mesh(name, surface, vertices, self.triangles, np.divide(normals, length, where=length > 0, out=normals))


def carried(ref: Ref, spacing: float, mesh: ElementMesh, assembly: Assembly) -> Carried:
    """The polygons of an object at the start of the run, as elements of its material carry them."""
    vertices, triangles, normals = _polygons(ref, spacing, assembly)
    cell, at = _places(mesh, vertices)
    corner = mesh.points[mesh.cells[cell]]
    slopes = mesh.element.slopes(at)
    local = slopes[:, :, 1:] - slopes[:, :, :1]
    sides = np.einsum("vki,vkj->vij", corner - corner[:, :1], local)
    gradients = local @ np.linalg.inv(sides)
    return Carried(triangles, mesh.cells[cell], mesh.element.functions(at), gradients, normals)


def _polygons(ref: Ref, spacing: float, assembly: Assembly) -> tuple[Floats, Ints, Floats | None]:
    """Vertices (v, 3), triangles (m, 3), and normals (v, 3) where the polygons have some."""
    from sceneql.bodies.filling.fill import Inside
    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.island.start import Start
    from sceneql.mesh.dual.sharp import polygonise_sharp

    kind: Any = assembly.object(ref)
    start: Any = Start(assembly)
    corners = getattr(kind, "triangles_at", None)
    if corners is not None:
        vertices, which = np.unique(corners(start).reshape(-1, 3), axis=0, return_inverse=True)
        return vertices, which.reshape(-1, 3).astype(np.int32), None
    box = Inside(ref, assembly)
    build = TapeBuilder()
    tape = build.finish(kind.implicit(build, build.x, build.y, build.z, start))
    cell = spacing / CELLS
    low, high = ((float(x), float(y), float(z)) for x, y, z in (box.low - cell, box.high + cell))
    found = polygonise_sharp(tape, low, high, cell)
    return found.vertices, found.triangles, found.normals


def _places(mesh: ElementMesh, vertices: Floats) -> tuple[Any, Floats]:
    """(v,) the element in which, or nearest to which, each vertex (v, 3) lies, and (v, 4) where in it."""
    from scipy.spatial import cKDTree

    corners = mesh.points[mesh.cells[:, :4]]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    _, near = cKDTree(corners.mean(axis=1)).query(vertices, k=min(CANDIDATES, len(corners)))
    near = near.reshape(len(vertices), -1)
    own = np.einsum("vcij,vcj->vci", inverse[near], vertices[:, None] - corners[near, 0])
    own = np.concatenate([1.0 - own.sum(axis=2, keepdims=True), own], axis=2)
    best = own.min(axis=2).argmax(axis=1)
    rows = np.arange(len(vertices))
    cell, at = near[rows, best], own[rows, best]
    nodes = mesh.points[mesh.cells[cell]]
    for _ in range(STEPS if mesh.element.edges else 0):
        slopes = mesh.element.slopes(at)
        sides = np.einsum("vki,vkj->vij", nodes, slopes[:, :, 1:] - slopes[:, :, :1])
        away = vertices - np.einsum("vk,vki->vi", mesh.element.functions(at), nodes)
        step = np.linalg.solve(sides, away[:, :, None])[:, :, 0]
        at = at + np.concatenate([-step.sum(axis=1, keepdims=True), step], axis=1)
    return cell, at
