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
"""Angle below which neighboring triangles are shaded as one smooth surface, where edges are kept."""


def skin(shape: Implicit, cells: int, sharp: bool) -> Mesh:
    """Triangles of an implicit solid with normals, and its colors where it is painted.

    ``cells`` along its longest side, finer where normals turn much or cells may hide thin parts; with ``sharp`` edges
    are kept instead. Raises ValueError as ``grid_around``.
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
    """The same triangles split at edges, with separate normals on either side."""
    import trimesh

    if not len(polygons.triangles):
        return polygons
    whole = trimesh.Trimesh(polygons.vertices, polygons.triangles, process=False)
    parted = trimesh.graph.smooth_shade(whole, angle=EDGE, facet_minarea=None)
    triangles = np.asarray(parted.faces, dtype=np.int32)
    return Polygons(np.asarray(parted.vertices, float), triangles, np.asarray(parted.vertex_normals, float))
