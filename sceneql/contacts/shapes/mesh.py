"""Colliders of meshes (mesh_kernels).

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.contacts.shapes.closed_mesh import closed
from sceneql.failure import LimitRefused
from sceneql.kinds import Collider

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints
    from sceneql.system import Assembly

MOST_TRIANGLES = 500_000
THINNEST = 1e-4
"""Thickness, relative to the mesh's size, below which a fast body might pass through it."""


def collider(vertices: Floats, triangles: Ints, position_at: int, rotation_at: int, assembly: Assembly) -> Collider:
    """Collider of a mesh of vertices (n, 3) [m] and triangles (m, 3) in its own coordinates.

    Raises ValueError for a mesh that cannot be closed, LimitRefused for one with too many triangles.
    """
    if len(triangles) > MOST_TRIANGLES:
        raise LimitRefused(f"a mesh of {len(triangles)} triangles is too large for contacts, at most {MOST_TRIANGLES}")
    mesh = closed(vertices, triangles)
    size = float(np.ptp(mesh.vertices, axis=0).max())
    edges = np.linalg.norm(mesh.corners - np.roll(mesh.corners, -1, axis=1), axis=2)
    depth = max(1e-3 * THINNEST * size, min(THINNEST * size, 0.25 * float(edges.min())))
    data = (assembly.floats(mesh.boxes), assembly.floats(mesh.rows), len(mesh.boxes), *mesh.tree.ravel().tolist())
    size_at = assembly.floats([size])
    return Collider(
        "sceneql.contacts.shapes.mesh_kernels", position_at, rotation_at, size_at, assembly.floats([depth]), data
    )
