"""Convex shapes as the kernels of distances read them: half spaces, and polyhedra, which may be rounded by a radius.

A ball is a point with a radius, a capsule a segment with one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

CORE, HALF_SPACE, SKINNED, POINT = range(4)
"""Kinds: a polyhedron, segment or point with a radius; all on one side of a plane; what is met by its skin alone
(contact_skins.py), here a ball around it; a mass, which meets the others by itself (mass_points_kernels.py)."""
COPLANAR = 1e-9
"""Angle [rad] between triangles of a convex hull up to which they are parts of one face."""
VERTICES = 2
"""Number of a CORE at which its vertices begin."""
SHAPE = 3
"""Integers of a shape: its kind, and the offsets of its numbers and of its integers."""


@dataclass(frozen=True, slots=True, eq=False)
class Convex:
    """A convex shape in the axes of its body, whose center of mass is the origin."""

    kind: int
    floats: Floats
    """Its radius and the distance of its farthest point from the origin [m]; then of a CORE the vertices (v, 3) [m] and
    the outer unit normals of the faces (f, 3), of a HALF_SPACE its outer unit normal (3,) and n.x of its plane [m]."""
    ints: NDArray[int64]
    """Of a CORE: numbers v, f, e of vertices, faces and edges, length of all loops, then where the loop of each face
    begins (f + 1), the loops, counterclockwise from outside, and the edges (e, 4): vertices and faces (-1: none)."""

    @property
    def reach(self) -> float:
        """Distance of its farthest point from the origin [m]."""
        _, found, *_ = self.floats.tolist()
        return float(found)

    @property
    def radius(self) -> float:
        """Radius around its core [m]."""
        found, *_ = self.floats.tolist()
        return float(found)

    @property
    def vertices(self) -> Floats:
        """Of a CORE: its vertices (v, 3) [m]."""
        return self.floats[VERTICES : VERTICES + 3 * int(self.ints[0])].reshape(-1, 3)

    @property
    def normals(self) -> Floats:
        """Of a CORE: the outer unit normals of its faces (f, 3)."""
        return self.floats[VERTICES + 3 * int(self.ints[0]) :].reshape(-1, 3)


def mass() -> Convex:
    """What stands for a mass among the shapes."""
    return Convex(POINT, np.zeros(0), np.zeros(0, dtype=np.int64))


def ball(radius: float, center: Sequence[float] | Floats = (0.0, 0.0, 0.0)) -> Convex:
    """A ball [m]."""
    # The edge without a length lets the vertex be found where edges are looked at.
    return _core(np.reshape(np.array(center, dtype=float), (1, 3)), [], radius, [(0, 0, -1, -1)])


def capsule(start: Sequence[float], end: Sequence[float], radius: float) -> Convex:
    """All points within a radius [m] of a segment [m]."""
    return _core(np.array([start, end], dtype=float), [], radius, [(0, 1, -1, -1)])


def box(half: Sequence[float], radius: float = 0.0) -> Convex:
    """A block of half sides [m] (without the radius) around the origin, along the axes of its body."""
    signs = np.array([[(k & 1), (k >> 1) & 1, k >> 2] for k in range(8)]) * 2.0 - 1.0
    loops = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return _core(signs * np.asarray(half, dtype=float), loops, radius)


def hull(points: Floats, radius: float = 0.0) -> Convex:
    """The convex hull of points (n, 3) [m], with faces in one plane joined.

    Raises ValueError where the points lie in a plane.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = np.asarray(points, dtype=float)
    try:
        found = ConvexHull(points)
    except QhullError:
        raise ValueError("the points lie in a plane: their convex hull has no volume") from None
    patch = _patches(found.equations[:, :3], found.neighbors)
    faces_at: dict[int, set[int]] = {}
    for triangle, number in zip(found.simplices, patch, strict=True):
        for vertex in triangle:
            faces_at.setdefault(int(vertex), set()).add(number)
    kept = sorted(vertex for vertex, faces in faces_at.items() if len(faces) > 2)
    new = {vertex: k for k, vertex in enumerate(kept)}
    loops = []
    for number in sorted(set(patch)):
        normal = found.equations[patch.index(number), :3]
        corners = [vertex for vertex in kept if number in faces_at[vertex]]
        loops.append([new[vertex] for vertex in _around(corners, points, normal)])
    return _core(points[kept], loops, radius)


def half_space(normal: Sequence[float] | Floats, offset: float) -> Convex:
    """All points x with normal.x at most ``offset`` [m]; the normal points out of it, and has any length but 0."""
    length = float(np.linalg.norm(normal))
    numbers = np.array([0.0, np.inf, *(np.asarray(normal, dtype=float) / length), offset])
    return Convex(HALF_SPACE, numbers, np.zeros(0, dtype=np.int64))


def joined(shapes: Sequence[Convex], floats_at: int = 0, ints_at: int = 0) -> tuple[Floats, NDArray[int64]]:
    """Numbers and integers of shapes, to be put where ``floats_at`` and ``ints_at`` say; the integers begin with SHAPE
    of each shape."""
    numbers, integers = floats_at, ints_at + SHAPE * len(shapes)
    heads = []
    for shape in shapes:
        heads += [shape.kind, numbers, integers]
        numbers, integers = numbers + len(shape.floats), integers + len(shape.ints)
    ints = np.concatenate([np.array(heads, dtype=np.int64), *(shape.ints for shape in shapes)])
    return np.concatenate([np.zeros(0), *(shape.floats for shape in shapes)]), ints


def room_length(shapes: Sequence[Convex]) -> int:
    """Numbers of working memory that the kernels of distances need for any two of the shapes."""
    from sceneql.contacts.distance.core_kernels import ROOM

    cores = [shape.ints.tolist() for shape in shapes if shape.kind == CORE]
    longest = max((4 * vertices + 3 * faces + 14 * (loops + 2) for vertices, faces, _, loops, *_ in cores), default=0)
    return ROOM + 2 * longest


def _core(
    vertices: Floats, loops: Sequence[Sequence[int]], radius: float, edges: Sequence[Sequence[int]] = ()
) -> Convex:
    reach = radius + float(np.linalg.norm(vertices, axis=1).max())
    normals = np.array([_normal(vertices[list(loop)]) for loop in loops]).reshape(-1, 3)
    beside = {
        (loop[k], loop[(k + 1) % len(loop)]): number for number, loop in enumerate(loops) for k in range(len(loop))
    }
    edges = [(a, b, face, beside[b, a]) for (a, b), face in sorted(beside.items()) if a < b] or edges
    starts = np.cumsum([0, *map(len, loops)])
    counts = [len(vertices), len(loops), len(edges), starts[-1]]
    ints = [*counts, *starts, *(vertex for loop in loops for vertex in loop), *np.ravel(edges)]
    floats = np.concatenate([[radius, reach], vertices.ravel(), normals.ravel()])
    return Convex(CORE, floats, np.array(ints, dtype=np.int64))


def _normal(corners: Floats) -> Floats:
    """The unit normal of a polygon (n, 3), by its area (Newell)."""
    away = corners - corners[0]
    across: Floats = np.cross(away[1:-1], away[2:]).sum(axis=0)
    return across / np.linalg.norm(across)


def _patches(normals: Floats, neighbors: NDArray[int64]) -> list[int]:
    """The number of the face of each triangle of a hull: neighbors in one plane are of one face."""
    patch = [-1] * len(normals)
    count = 0
    for first in range(len(normals)):
        if patch[first] >= 0:
            continue
        todo = [first]
        while todo:
            one = todo.pop()
            if patch[one] < 0:
                patch[one] = count
                near = (int(other) for other in neighbors[one])
                todo += [k for k in near if np.linalg.norm(np.cross(normals[k], normals[first])) <= COPLANAR]
        count += 1
    return patch


def _around(corners: list[int], points: Floats, normal: Floats) -> list[int]:
    """The corners of a face in order around its normal."""
    away = points[corners] - points[corners].mean(axis=0)
    first = away[0] / np.linalg.norm(away[0])
    angles = np.arctan2(away @ np.cross(normal, first), away @ first)
    return [corners[k] for k in np.argsort(angles, kind="stable")]
