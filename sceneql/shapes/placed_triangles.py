"""Triangles in the world: positions, orientation and normals."""

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
        """(n, 3) unit normals of the vertices; None where triangles are shaded flat."""


@dataclass(frozen=True, slots=True, eq=False)
class PlacedTriangles:
    """Arrays of a frame.Mesh, in world coordinates."""

    vertices: Floats
    triangles: Ints
    normals: Floats | None


def placed(of: Triangulated, place: Floats) -> PlacedTriangles:
    """Triangles mapped by a place (3, 4); where the map mirrors, the order of their corners is reversed."""
    import numpy as np

    triangles = of.triangles if np.linalg.det(place[:, :3]) > 0 else of.triangles[:, ::-1].copy()
    normals = None
    if of.normals is not None:
        normals = of.normals @ np.linalg.inv(place[:, :3])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return PlacedTriangles(apply(place, of.vertices), triangles, normals)


def still(of: Triangulated, name: str, place: Floats, moment: Moment) -> PlacedTriangles:
    """As ``placed``, with held arrays: the same objects for a part as long as its place stays the same.

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
