"""Triangles in the world: their places, the side that they turn to the front, and their normals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from sceneql.shapes.placement import apply

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints
    from sceneql.kinds import Moment


class Triangulated(Protocol):
    """Triangles in coordinates of their own."""

    @property
    def vertices(self) -> Floats:
        """(n, 3)"""

    @property
    def triangles(self) -> Ints:
        """(m, 3) indices."""

    @property
    def normals(self) -> Floats | None:
        """(n, 3) unit, of one that is smooth."""


@dataclass(frozen=True, slots=True, eq=False)
class PlacedTriangles:
    """As frame.Mesh has them."""

    vertices: Floats
    triangles: Ints
    normals: Floats | None


def placed(of: Triangulated, place: Floats) -> PlacedTriangles:
    """Triangles mapped by a place (3, 4); where that mirrors, their corners are taken the other way round."""
    import numpy as np

    triangles = of.triangles if np.linalg.det(place[:, :3]) > 0 else of.triangles[:, ::-1].copy()
    normals = None
    if of.normals is not None:
        normals = of.normals @ np.linalg.inv(place[:, :3])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return PlacedTriangles(apply(place, of.vertices), triangles, normals)


def still(of: Triangulated, name: str, place: Floats, moment: Moment) -> PlacedTriangles:
    """As ``placed``, with arrays that are held: the same ones for a part as long as it stays where it is.

    ``of`` is known by its identity, and must not change.
    """
    from sceneql.frame import held

    def make() -> PlacedTriangles:
        made = placed(of, place)
        for array in (made.vertices, made.triangles, made.normals):
            if array is not None:
                held(array)
        return made

    return moment.kept(name, (of, place.tobytes()), make)
