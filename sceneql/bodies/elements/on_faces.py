"""Quadrature points on the outer faces of an element mesh, for loads and pictures. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

A, B = 0.091576213509770743, 0.44594849091596488
PLACES = (
    (1 - 2 * A, A, A),
    (A, 1 - 2 * A, A),
    (A, A, 1 - 2 * A),
    (1 - 2 * B, B, B),
    (B, 1 - 2 * B, B),
    (B, B, 1 - 2 * B),
)
WEIGHTS = (0.10995174365532187,) * 3 + (0.22338158967801147,) * 3
"""Weights, of sum 1, of the rule of degree 4 on a triangle with the nodes PLACES (Dunavant 1985)."""
GAUSS = 0.15**0.5
"""Distance of the outer two of Gauss's three points from the middle of an edge, as a share of it."""
PARTS = 12
"""Parts of a face's sides where only a part of the face may be loaded."""


def functions(places: Any, nodes: int) -> Floats:
    """Values (q, nodes) of the shape functions of a face's 3 or 6 nodes at barycentric points (q, 3)."""
    at = np.asarray(places, dtype=float)
    if nodes == 3:
        return at
    following = np.roll(at, -1, axis=1)
    return np.concatenate([at * (2.0 * at - 1.0), 4.0 * at * following], axis=1)


def slopes(places: Any, nodes: int) -> Floats:
    """Derivatives (q, nodes, 2) of the shape functions by the second and third barycentric coordinate.

    The first coordinate is 1 minus these two.
    """
    at = np.asarray(places, dtype=float)
    own = np.zeros((len(at), nodes, 3))
    for k in range(3):
        own[:, k, k] = 1.0 if nodes == 3 else 4.0 * at[:, k] - 1.0
        if nodes == 6:
            own[:, 3 + k, k], own[:, 3 + k, (k + 1) % 3] = 4.0 * at[:, (k + 1) % 3], 4.0 * at[:, k]
    return own[:, :, 1:] - own[:, :, :1]


def small_triangles(parts: int) -> Floats:
    """Barycentric corners (parts^2, 3, 3) of the triangles that a triangle is divided into, of the same orientation."""
    found = []
    for i in range(parts):
        for j in range(parts - i):
            found.append([(i, j), (i + 1, j), (i, j + 1)])
            if i + j < parts - 1:
                found.append([(i + 1, j), (i + 1, j + 1), (i, j + 1)])
    at = np.array(found, dtype=float) / parts
    return np.concatenate([1.0 - at.sum(axis=2, keepdims=True), at], axis=2)


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Quadrature points on faces."""

    faces: NDArray[int64]
    """(k,) the face of each point."""
    places: Floats
    """(k, 3) its barycentric coordinates in the face."""
    shares: Floats
    """(k,) its weight: the area in the face's barycentric coordinates, 1/2 for a whole face."""

    def at(self, points: Floats, faces: Ints) -> Floats:
        """Positions (k, 3) [m], for faces (f, 3 or 6) with nodes ``points`` (n, 3) [m]."""
        found: Floats = np.einsum("kn,kni->ki", functions(self.places, faces.shape[1]), points[faces[self.faces]])
        return found

    def areas(self, points: Floats, faces: Ints) -> Floats:
        """The area (k,) [m^2] that each point stands for."""
        ends = np.einsum("kns,kni->ksi", slopes(self.places, faces.shape[1]), points[faces[self.faces]])
        found: Floats = self.shares * np.linalg.norm(np.cross(ends[:, 0], ends[:, 1]), axis=1)
        return found

    def some(self, which: Any) -> Spread:
        """The points that a mask (k,) selects."""
        return Spread(self.faces[which], self.places[which], self.shares[which])


def spread(which: Any, finely: bool) -> Spread:
    """Quadrature points on all faces ``which`` (f,): PARTS^2 on each if ``finely``, else Dunavant's six."""
    if finely:
        places = small_triangles(PARTS).mean(axis=1)
        shares = np.full(len(places), 0.5 / len(places))
    else:
        places, shares = np.array(PLACES), 0.5 * np.array(WEIGHTS)
    k = len(places)
    return Spread(np.repeat(which, k), np.tile(places, (len(which), 1)), np.tile(shares, len(which)))


def nearest(points: Floats, faces: Ints, place: Floats) -> Spread:
    """The single point on the faces, taken as flat triangles, that is nearest to a place (3,) [m]."""
    from trimesh import triangles

    on_triangles: Any = triangles

    corners = points[faces[:, :3]]
    found = on_triangles.closest_point(corners, np.broadcast_to(place, (len(faces), 3)))
    k = int(np.argmin(np.linalg.norm(found - place, axis=1)))
    at = on_triangles.points_to_barycentric(corners[k : k + 1], found[k : k + 1])
    return Spread(np.array([k]), at, np.ones(1))


def line_shares(points: Floats, edges: Any) -> Floats:
    """What part (n,) of a force spread along edges (m, 2 or 3), with nodes ``points`` (n, 3) [m], acts on each node.

    The third node is the one between the ends. Gauss's rule of three points, by the length of the curved edge.
    """
    at = np.array([0.5 - GAUSS, 0.5, 0.5 + GAUSS])
    shapes, ways = np.stack([1.0 - at, at], axis=1), np.tile([-1.0, 1.0], (3, 1))
    if edges.shape[1] == 3:
        shapes = np.stack([(1.0 - at) * (1.0 - 2.0 * at), at * (2.0 * at - 1.0), 4.0 * at * (1.0 - at)], axis=1)
        ways = np.stack([4.0 * at - 3.0, 4.0 * at - 1.0, 4.0 - 8.0 * at], axis=1)
    lengths = np.linalg.norm(ways @ points[edges], axis=2) * (np.array([5.0, 8.0, 5.0]) / 18.0)
    found = np.zeros(len(points))
    np.add.at(found, edges, lengths @ shapes / lengths.sum())
    return found
