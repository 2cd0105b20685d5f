"""Display meshes of implicit solids."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Mesh
from sceneql.mesh.polygons import Polygons

if TYPE_CHECKING:
    from sceneql.frame import Implicit

EDGE = math.radians(30)
"""Angle [rad] below which neighboring triangles are shaded as one smooth surface, if edges are kept."""


def skin(shape: Implicit, cells: int, sharp: bool) -> Mesh:
    """Mesh of an implicit solid with normals, and with colors if it is painted.

    ``cells``: number along its longest side; finer near strongly curved and possibly thin parts. ``sharp``: keeps
    edges instead. Raises ValueError as ``grid_around``.
    """
    from sceneql.field.tape.tape_solid import paint_values
    from sceneql.mesh.cubes.refine import refined
    from sceneql.mesh.dual.sharp import polygonise_sharp

    cell = max(high - low for low, high in zip(shape.low, shape.high, strict=True)) / cells
    if sharp:
        made = _creased(polygonise_sharp(shape.tape, shape.low, shape.high, cell))
    else:
        made, _ = refined(shape.tape, shape.low, shape.high, cell)
    found = Mesh(shape.name, shape.surface, made.vertices, made.triangles, made.normals)
    return found if shape.paint is None else replace(found, colors=paint_values(shape.paint, made.vertices))


def _creased(polygons: Polygons) -> Polygons:
    """Triangles split at edges, with separate normals on both sides."""
    import trimesh

    if not len(polygons.triangles):
        return polygons
    whole = trimesh.Trimesh(polygons.vertices, polygons.triangles, process=False)
    parted = trimesh.graph.smooth_shade(whole, angle=EDGE, facet_minarea=None)
    triangles = np.asarray(parted.faces, dtype=np.int32)
    return Polygons(np.asarray(parted.vertices, float), triangles, np.asarray(parted.vertex_normals, float))
