"""The inside of a closed mesh as a domain (domain.cut.Level)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.contacts import layout
from sceneql.contacts.shapes.closed_mesh import closed
from sceneql.shapes.of_contents import OfContents

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

TILE = 4096
"""Points of one task of a thread."""
REMEMBERED = 32
"""Arrays of points whose distances are cached: those of a grid's cells, which a run before the film evaluates, too."""


class MeshLevel:
    """The inside of a closed mesh as a level set; phi is the signed distance, and the boundary is one piece."""

    flat = False

    def __init__(self, corners: Floats, name: str) -> None:
        """``corners`` (m, 3, 3) [m]. Raises ValueError for a mesh that is open."""
        mesh = closed(corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3))
        self.names = (name,)
        self.bounds = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self._floats = np.concatenate([mesh.boxes.ravel(), mesh.rows.ravel()])
        data = [0, mesh.boxes.size, len(mesh.boxes), *mesh.tree.ravel().tolist()]
        self._ints = np.array([*[0] * layout.DATA, layout.DATA + 1, *data], dtype=np.int64)
        self._found: OfContents[Floats] = OfContents(REMEMBERED)

    def values(self, points: Floats) -> Floats:
        """Signed distances (k,) [m] at points (k, 3) [m], negative inside."""
        return self._found.get((points,), lambda: self._distances(points))

    def _distances(self, points: Floats) -> Floats:
        from sceneql.compiled.kernels import over_tiles
        from sceneql.contacts.shapes.mesh_domain_kernels import distances

        points, found = np.ascontiguousarray(points), np.empty(len(points))

        def work(tile: int) -> None:
            last = min(len(points), (tile + 1) * TILE)
            distances(self._floats, self._ints, points, found, tile * TILE, last)

        over_tiles(-(-len(points) // TILE), work)
        return found

    def pieces(self, points: Floats) -> NDArray[int64]:
        """(k,) zeros."""
        return np.zeros(len(points), dtype=np.int64)


def mesh_level(corners: Floats, name: str) -> MeshLevel:
    """The MeshLevel of an object's triangles (m, 3, 3) [m], cached. Raises ValueError for a mesh that is open."""
    return _KNOWN.get((corners, np.frombuffer(name.encode(), np.uint8)), lambda: MeshLevel(corners, name))


_KNOWN: OfContents[MeshLevel] = OfContents()
