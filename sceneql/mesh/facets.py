"""Meshes of a frame's implicit shapes, for renderers and measures that know only triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats, Implicit, Ints, Mesh


def faceted(shape: Implicit, cell: float, smooth: bool) -> Mesh:
    """The mesh of an implicit shape by marching cubes with cells of side ``cell`` [m]; with normals if ``smooth``.

    A shape with paint gives its vertices colors. Raises ValueError as ``polygonise``.
    """
    from sceneql.field.tape.tape_solid import paint_values
    from sceneql.frame import Mesh
    from sceneql.mesh.cubes.polygonise import polygonise

    polygons = polygonise(shape.tape, shape.low, shape.high, cell)
    colors = None if shape.paint is None else paint_values(shape.paint, polygons.vertices)
    normals = polygons.normals if smooth else None
    return Mesh(shape.name, shape.surface, polygons.vertices, polygons.triangles, normals, colors)


def edges(vertices: Floats, triangles: Ints) -> Floats:
    """(e, 2, 3) the two ends of every edge, each edge once."""
    import numpy as np

    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    ends: Floats = vertices[np.unique(pairs, axis=0)]
    return ends
