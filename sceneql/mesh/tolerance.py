"""Cells fine enough for a distance between the triangles and the surface. Imports numpy and numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from sceneql.field.solid import field_values, many_gradients
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.polygonise import polygonise
from sceneql.mesh.polygons import Polygons

if TYPE_CHECKING:
    from sceneql.frame import Tape

Method = Callable[["Tape", Corner, Corner, float], Polygons]
PROBES = 10_000
"""Triangles that a distance is measured at."""
BETWEEN = 16.0 / 15.0
"""What a smooth surface may be farther from a triangle than at its center and the middles of its edges: the difference
is sum d_ij l_i l_j in barycentric coordinates, largest beside these places where d = (1, 1, 1/4)."""
TRIES = 8
SAFETY = 0.9


def distance(tape: Tape, polygons: Polygons) -> float:
    """The largest distance [m] of the triangles from the surface, by their centers and the middles of their edges.

    There it is |f| / |grad f|, right to first order; BETWEEN them a surface that is smooth across a triangle is nearer
    to second order, one with an edge or a corner there may be farther. What has no triangle near it, as a piece that
    cells do not see, is not measured. Where there are more than PROBES triangles, every so many-th is looked at.
    """
    import numpy as np

    triangles = polygons.triangles[:: max(1, len(polygons.triangles) // PROBES)]
    if not len(triangles):
        return 0.0
    corners = polygons.vertices[triangles]
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    places = np.concatenate([corners.mean(axis=1), middles.reshape(-1, 3)])
    slopes = np.linalg.norm(many_gradients(tape, places), axis=1)
    steep = slopes > 0.0
    return BETWEEN * float(np.max(np.abs(field_values(tape, places[steep])) / slopes[steep], initial=0.0))


def polygonise_within(
    tape: Tape, low: Corner, high: Corner, tolerance: float, cell: float, method: Method = polygonise
) -> tuple[Polygons, float]:
    """Triangles that are within ``tolerance`` [m] of the surface, as of ``distance``, and their cell [m] <= ``cell``.

    The distance falls with the square of the cell, at edges and corners that are not kept with the cell itself: the
    cell is shortened by what is measured. Raises ValueError as ``method``, and where TRIES cells do not reach it.
    """
    import numpy as np

    if not tolerance > 0.0:
        raise ValueError("the tolerance must be above 0")
    whole = bounded(tape, low, high)
    for _ in range(TRIES):
        polygons = method(tape, low, high, cell)
        found = distance(whole, polygons)
        if found <= tolerance:
            return polygons, cell
        cell *= max(0.25, min(0.7, SAFETY * float(np.sqrt(tolerance / found))))
    raise ValueError(f"{TRIES} cells, the last of {cell:g} m, did not come within {tolerance:g} m of the surface")
