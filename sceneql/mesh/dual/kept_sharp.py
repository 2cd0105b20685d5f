"""Meshes with sharp edges and corners, and the topology of ``refined``. Imports numpy, numba and scipy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.refine import refined
from sceneql.mesh.cubes.unresolved import Unresolved, unresolved
from sceneql.mesh.dual.sharp import polygonise_sharp
from sceneql.mesh.dual.sharpened import sharpened
from sceneql.mesh.measures import euler_by_piece
from sceneql.mesh.polygons import Polygons

if TYPE_CHECKING:
    from sceneql.frame import Tape


def kept_sharp(tape: Tape, low: Corner, high: Corner, cell: float) -> tuple[Polygons, Unresolved]:
    """A mesh as of ``refined``, but with edges and corners kept sharp, and its unresolved cells.

    By dual contouring. Where a solid touches itself, or a passage is narrower than a cell, its mesh may differ from
    ``refined`` in topology; then the Euler characteristics of the pieces differ, and the mesh of ``refined`` is used,
    cut along the solid's edges (``sharpened``). Raises ValueError as ``grid_around``.
    """
    found, left = refined(tape, low, high, cell)
    dual = polygonise_sharp(tape, low, high, cell)
    if euler_by_piece(dual.triangles) == euler_by_piece(found.triangles):
        return dual, unresolved(tape, low, high, cell)
    return sharpened(bounded(tape, low, high), found), left
