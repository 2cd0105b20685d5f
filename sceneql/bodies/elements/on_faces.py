"""Places on the outer faces of a mesh of elements, for loads and pictures. Imports numpy."""

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
"""Of a triangle of area 1: exact to fourth order (Dunavant 1985)."""
PARTS = 12
"""Into so many parts the sides of a face are cut where only a part of it may be loaded."""


def functions(places: Any, nodes: int) -> Floats:
    """(q, nodes) the functions of a face's nodes at barycentric places (q, 3)."""
    at = np.asarray(places, dtype=float)
    if nodes == 3:
        return at
    following = np.roll(at, -1, axis=1)
    return np.concatenate([at * (2.0 * at - 1.0), 4.0 * at * following], axis=1)


def slopes(places: Any, nodes: int) -> Floats:
    """(q, nodes, 2) their derivatives by the second and the third coordinate, the first being what is left."""
    at = np.asarray(places, dtype=float)
    own = np.zeros((len(at), nodes, 3))
    for k in range(3):
        own[:, k, k] = 1.0 if nodes == 3 else 4.0 * at[:, k] - 1.0
        if nodes == 6:
            own[:, 3 + k, k], own[:, 3 + k, (k + 1) % 3] = 4.0 * at[:, (k + 1) % 3], 4.0 * at[:, k]
    return own[:, :, 1:] - own[:, :, :1]


def small_triangles(parts: int) -> Floats:
    """(parts^2, 3, 3) barycentric corners of the triangles that a triangle is cut into, all the same way round."""
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
    """Places on faces, and the area of the material that each stands for."""

    faces: NDArray[int64]
    """(k,) which face each is on."""
    places: Floats
    """(k, 3) barycentric."""
    shares: Floats
    """(k,) of the face's area in its own coordinates, half of which is that of the whole."""

    def at(self, points: Floats, faces: Ints) -> Floats:
        """(k, 3) where they are."""
        found: Floats = np.einsum("kn,kni->ki", functions(self.places, faces.shape[1]), points[faces[self.faces]])
        return found

    def areas(self, points: Floats, faces: Ints) -> Floats:
        """(k,) [m^2]."""
        ends = np.einsum("kns,kni->ksi", slopes(self.places, faces.shape[1]), points[faces[self.faces]])
        found: Floats = self.shares * np.linalg.norm(np.cross(ends[:, 0], ends[:, 1]), axis=1)
        return found

    def some(self, which: Any) -> Spread:
        """Those of them that a mask chooses."""
        return Spread(self.faces[which], self.places[which], self.shares[which])


def spread(which: Any, finely: bool) -> Spread:
    """Places on all of the faces ``which`` (f,); ``finely``: so many that a part of a face is seen."""
    if finely:
        places = small_triangles(PARTS).mean(axis=1)
        shares = np.full(len(places), 0.5 / len(places))
    else:
        places, shares = np.array(PLACES), 0.5 * np.array(WEIGHTS)
    k = len(places)
    return Spread(np.repeat(which, k), np.tile(places, (len(which), 1)), np.tile(shares, len(which)))


def nearest(points: Floats, faces: Ints, place: Floats) -> Spread:
    """The place of the faces' triangles of corners that is nearest to one (3,)."""
    from trimesh import triangles

    on_triangles: Any = triangles

    corners = points[faces[:, :3]]
    found = on_triangles.closest_point(corners, np.broadcast_to(place, (len(faces), 3)))
    k = int(np.argmin(np.linalg.norm(found - place, axis=1)))
    at = on_triangles.points_to_barycentric(corners[k : k + 1], found[k : k + 1])
    return Spread(np.array([k]), at, np.ones(1))
