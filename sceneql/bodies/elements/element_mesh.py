"""Meshes of finite elements: nodes, outer faces, Jacobians and mass matrices; elements with curved edges.

Imports numpy.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import permutations
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.kept_creases import CREASE
from sceneql.bodies.filling.tetrahedra import ENDS, boundary, edges

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.bodies.elements.element import Element
    from sceneql.frame import Floats, Ints

FACE_EDGES = ((0, 1), (1, 2), (2, 0))
"""The edges of a face, by its corners; the face's further nodes are on them, in this order."""
FINE: tuple[tuple[float, float], ...] = (
    (0.09273525031089123, 0.07349304311636194),
    (0.3108859192633006, 0.11268792571801585),
)
"""Points of a quadrature rule of degree 5 near corners and near faces, (coordinate, weight); those near edges are
FINE_EDGES (Walkington 2000)."""
FINE_EDGES = (0.04550370412564964, 0.04254602077708147)


@dataclass(frozen=True, slots=True, eq=False)
class OnLine:
    """Nodes on a line or at a point of the surface that a hold or a load names."""

    nodes: Any
    """(k,)."""
    edges: Any
    """(m, 2 or 3) the outer edges on the line: their ends, and the node between them."""
    inside: bool
    """Whether nodes inside that stand on it belong to it, too."""


@dataclass(frozen=True, slots=True, eq=False)
class ElementMesh:
    """A mesh of elements of one kind."""

    element: type[Element]
    points: Floats
    """(n, 3) [m] material positions of the nodes, corners first."""
    cells: Ints
    """(e, nodes) the nodes of each element."""
    corners: int
    """Number of nodes that are corners of elements."""
    lines: Mapping[str, OnLine] = field(default_factory=dict)
    """By the name of a hold or a load, the nodes on its line or point."""
    put: tuple[int, int] = (0, 0)
    """How many vertices were added for lines and points, and how many were moved there."""

    def told(self) -> str:
        """What was changed for lines and points; empty for nothing."""
        return "; for lines and points {} nodes were added and {} moved".format(*self.put) if any(self.put) else ""

    @property
    def faces(self) -> Ints:
        """(f, 3 or 6) nodes of the outer faces: corners counterclockwise from outside, then the nodes on FACE_EDGES."""
        faces = boundary(self.cells[:, :4])
        if not self.element.edges:
            return faces
        ends, which = edges(self.cells[:, :4])
        middle = np.empty(len(ends), dtype=np.int64)
        middle[which.ravel()] = self.cells[:, 4:].ravel()
        size = int(ends.max()) + 1
        keys = ends @ (size, 1)
        sides = np.sort(faces[:, FACE_EDGES].astype(np.int64), axis=2) @ (size, 1)
        found: Ints = np.concatenate([faces, middle[np.searchsorted(keys, sides)]], axis=1).astype(np.int32)
        return found

    def at(self, places: Any) -> Floats:
        """Positions (e, q, 3) [m] of the points with barycentric coordinates (q, 4) in each element."""
        found: Floats = self.element.functions(places) @ self.points[self.cells]
        return found

    def _sides(self, places: Any) -> tuple[Floats, Floats]:
        """Jacobians (e, q, 3, 3) [m] of positions, and derivatives (q, nodes, 3) of shape functions, at points (q, 4).

        Both by the last three barycentric coordinates.
        """
        slopes = self.element.slopes(np.asarray(places, dtype=float))
        local = slopes[:, :, 1:] - slopes[:, :, :1]
        corner = self.points[self.cells] - self.points[self.cells[:, :1]]
        sides = np.stack([np.swapaxes(corner, 1, 2) @ one for one in local], axis=1)
        return sides, local

    def sizes(self, places: Any) -> Floats:
        """Jacobian determinants (e, q) [m^3], six times the volume of a straight element; negative if inverted."""
        sides, _ = self._sides(places)
        a, b, c = (sides[..., k] for k in range(3))
        found: Floats = np.sum(a * np.cross(b, c), axis=-1)
        return found

    def gradients(self, places: Any) -> Floats:
        """Gradients (e, q, nodes, 3) [1/m] of the shape functions at points (q, 4); no element may be flat."""
        sides, local = self._sides(places)
        found: Floats = local @ np.linalg.inv(sides)
        return found

    def tables(self) -> tuple[Floats, Floats]:
        """Gradients (e, q, nodes, 3) [1/m] at the integration points, and the points' shares of volume (e, q) [m^3]."""
        places, weights = self.element.rule
        return self.gradients(places), self.sizes(places) * np.asarray(weights) / 6.0

    def mass(self, density: Callable[[Floats], Floats]) -> Floats:
        """Consistent mass matrices (e, nodes, nodes) [kg] of the elements.

        ``density``: a function of positions (k, 3) [m], in kg/m^3.
        """
        places, weights = fine_rule()
        shapes = self.element.functions(places)
        size = self.sizes(places)
        held = density(self.at(places).reshape(-1, 3)).reshape(size.shape) * size * weights / 6.0
        products = shapes[:, :, None] * shapes[:, None, :]
        found: Floats = (held @ products.reshape(len(places), -1)).reshape(len(held), *products.shape[1:])
        return found


def fine_rule() -> tuple[Floats, Floats]:
    """Barycentric points (14, 4) and weights (14,) of a rule of degree 5 (Walkington 2000)."""
    places, weights = [], []
    for one, weight in FINE:
        for k in range(4):
            place = [one] * 4
            place[k] = 1.0 - 3.0 * one
            places.append(place)
            weights.append(weight)
    one, weight = FINE_EDGES
    edges = sorted(set(permutations((one, one, 0.5 - one, 0.5 - one))))
    return np.array([*places, *edges]), np.array([*weights, *(weight for _ in edges)])


@dataclass(frozen=True, slots=True, eq=False)
class Onto:
    """Projections of points near the surface of an object onto it."""

    surface: Callable[[Floats, Floats], Floats]
    """Moves points (k, 3) along unit normals (k, 3) onto the surface; points that do not reach it stay."""
    crease: Callable[[Floats, Floats, Floats], Floats]
    """Moves points (k, 3) onto a crease, by normals (k, 2, 3) of the two surfaces that meet there and unit directions
    (k, 2, 3) from it into these surfaces; NaN where the crease is not found."""
    line: Callable[[ElementMesh, Floats], Floats] | None = None
    """Moves nodes (n, 3) of a mesh, which are on the surface, onto lines on it."""


def meshed(element: type[Element], points: Floats, tetrahedra: Ints, onto: Onto | None = None) -> ElementMesh:
    """The mesh of elements on tetrahedra (t, 4) of points (n, 3).

    With ``onto`` the nodes on outer edges are moved onto the object's surface, where no element is bent too much.
    """
    if not element.edges:
        return ElementMesh(element, points, tetrahedra.astype(np.int32), len(points))
    ends, which = edges(tetrahedra)
    middles = 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])
    cells = np.concatenate([tetrahedra, len(points) + which], axis=1).astype(np.int32)
    straight = ElementMesh(element, np.concatenate([points, middles]), cells, len(points))
    return straight if onto is None else curved(straight, onto)[0]


LEAST_BENT = 0.2
"""Least Jacobian determinant of a curved element at the tested points, relative to the straight element's."""


def onto_object(straight: ElementMesh, onto: Onto) -> tuple[Floats, Creases]:
    """Nodes (n, 3) [m] with those on outer edges moved onto the surface, and those outer edges that are creases."""
    faces, points = straight.faces, straight.points
    normals = np.zeros_like(points)
    across = across_faces(points, faces)
    for k in range(6):
        np.add.at(normals, faces[:, k], across)
    outer = np.unique(faces[:, 3:])
    moved = points.copy()
    moved[outer] = onto.surface(points[outer], unit(normals[outer]))
    creases = Creases.of(points, faces)
    if len(creases.nodes):
        found = onto.crease(points[creases.nodes], creases.normals, creases.sides)
        met = ~np.isnan(found).any(axis=1)
        moved[creases.nodes[met]] = found[met]
    return (moved if onto.line is None else onto.line(straight, moved)), creases


def curved(straight: ElementMesh, onto: Onto) -> tuple[ElementMesh, int]:
    """The mesh with nodes on outer edges moved onto the surface, and the number of these that had to be moved back.

    Where elements are bent beyond LEAST_BENT their inner edges are bent along; where that does not suffice, nodes are
    moved back, those on creases only where the others do not suffice.
    """
    points, left = straight.points, 0
    moved, creases = onto_object(straight, onto)
    kept = np.isin(np.arange(len(points)), creases.nodes)
    outer = np.isin(np.arange(len(points)), straight.faces[:, 3:])
    places = np.concatenate([fine_rule()[0], np.eye(4), np.asarray(straight.element.rule[0])])
    least = LEAST_BENT * straight.sizes(places[:1])
    for attempt in range(len(points) + 1):
        mesh = ElementMesh(straight.element, moved, straight.cells, straight.corners)
        bad = (mesh.sizes(places) < least).any(axis=1)
        if not bad.any():
            return mesh, left
        if attempt == 0:
            moved = _bent_along(straight, moved, bad)
            continue
        back = np.unique(straight.cells[bad, 4:])
        bent = (moved[back] != points[back]).any(axis=1)
        back = back[bent & ~kept[back]] if (bent & ~kept[back]).any() else back
        left += int(np.count_nonzero((moved[back] != points[back]).any(axis=1) & outer[back]))
        moved[back] = points[back]
    return straight, left


def _bent_along(straight: ElementMesh, moved: Floats, bad: Any) -> Floats:
    """Nodes (n, 3) [m] with inner edges of bad elements (e,) and of their neighbors bent along: moved harmonically.

    Corners and outer nodes stay where ``moved`` has them.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import splu

    count = len(straight.points)
    touched = np.isin(np.arange(count), straight.cells[bad])
    region = touched[straight.cells].any(axis=1)
    own = straight.cells[region]
    free = np.setdiff1d(own, np.concatenate([straight.faces.ravel(), straight.cells[~region].ravel()]))
    free = free[free >= straight.corners]
    if not len(free):
        return moved
    part = ElementMesh(straight.element, straight.points, own, straight.corners)
    places, weights = fine_rule()
    slopes = part.gradients(places)
    entries = np.einsum("eqni,eqmi,eq->enm", slopes, slopes, part.sizes(places) * weights, optimize=True)
    each = own.shape[1]
    at = np.repeat(own, each, axis=1).ravel(), np.tile(own, each).ravel()
    stiffness = coo_array((entries.ravel(), at), shape=(count, count)).tocsr()[free]
    moves = moved - straight.points
    moves[free] = 0.0
    moves[free] = splu(stiffness[:, free].tocsc()).solve(-(stiffness @ moves))
    found = moved.copy()
    found[free] += moves[free]
    return found


def across_faces(points: Floats, faces: Any) -> Floats:
    """Normals (f, 3) [m^2] of faces, from their corners; their length is twice the face's area."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    found: Floats = np.cross(b - a, c - a)
    return found


def unit(vectors: Floats) -> Floats:
    """Vectors (..., 3) normalized; zero vectors stay zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    found: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Creases:
    """Creases: outer edges with a large angle between the normals of their two faces (CREASE)."""

    nodes: Any
    """(k,) the node on each edge."""
    ends: Any
    """(k, 2) the corners at its ends."""
    normals: Floats
    """(k, 2, 3) unit normals of its two faces."""
    sides: Floats
    """(k, 2, 3) unit directions from the edge into these faces."""

    @classmethod
    def of(cls, points: Floats, faces: Ints) -> Creases:
        """The creases among the edges of outer faces (f, 6), nodes of ``points`` (n, 3)."""
        normals = unit(across_faces(points, faces))
        nodes = faces[:, 3:].ravel().astype(np.int64)
        twice = np.bincount(nodes)[nodes] == 2  # parts that touch along an edge have four faces there
        order = np.argsort(nodes, kind="stable")
        pairs = order[twice[order]].reshape(-1, 2)
        one, two = normals[pairs[:, 0] // 3], normals[pairs[:, 1] // 3]
        pairs = pairs[np.einsum("ki,ki->k", one, two) < CREASE]
        corners = faces[:, :3]
        start, end, top = (points[corners[pairs // 3, (pairs % 3 + k) % 3]] for k in range(3))
        way, sides = unit(end - start), top - start
        sides = unit(sides - np.einsum("kji,kji->kj", sides, way)[..., None] * way)
        ends = corners[pairs[:, :1] // 3, (pairs[:, :1] % 3 + np.arange(2)) % 3]
        return cls(nodes[pairs[:, 0]], ends, normals[pairs // 3], sides)


def gathered(cells: Ints, count: int) -> NDArray[int64]:
    """For each of ``count`` nodes its occurrences in the flattened ``cells`` (e, nodes): starts, then indices (CSR)."""
    flat = cells.ravel().astype(np.int64)
    starts = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=count))])
    return np.concatenate([starts, np.argsort(flat, kind="stable")])


def worst_angle(points: Floats, tetrahedra: Ints) -> tuple[float, float]:
    """Least and largest dihedral angle [rad] of the tetrahedra."""
    corner = points[tetrahedra]
    least, largest = np.pi, 0.0
    for a, b in ENDS:
        c, d = (k for k in range(4) if k not in (a, b))
        along = corner[:, b] - corner[:, a]
        along = along / np.linalg.norm(along, axis=1, keepdims=True)
        sides = [corner[:, k] - corner[:, a] for k in (c, d)]
        one, two = (side - np.sum(side * along, axis=1, keepdims=True) * along for side in sides)
        cosine = np.sum(one * two, axis=1) / (np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1))
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        least, largest = min(least, float(angle.min())), max(largest, float(angle.max()))
    return least, largest
