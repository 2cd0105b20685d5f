"""The outer faces of a mesh of elements in pictures. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.bodies.spring_look import vertex_normals
from sceneql.frame import Mesh, Surface

if TYPE_CHECKING:
    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.frame import Floats, Ints

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
