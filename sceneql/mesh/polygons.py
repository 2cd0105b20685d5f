"""The triangle mesh that polygonization returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """Triangles of a solid's surface, counterclockwise seen from outside."""

    vertices: Floats
    """(n, 3) [m]."""
    triangles: Ints
    """(m, 3)."""
    normals: Floats
    """(n, 3) unit gradients, pointing outward; zero where the field has none, and on edges and corners kept sharp."""
