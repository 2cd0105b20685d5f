"""Meshes within a tolerance of the surface: the cell size is reduced until it is met. Imports numpy and numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from sceneql.field.tape.tape_solid import field_values, many_gradients
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.unresolved import Unresolved
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.move_vertices import settled

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

Method = Callable[["Tape", Corner, Corner, float], tuple[Polygons, Unresolved]]
PROBES = 10_000
"""Most triangles, or cells, at which a distance is measured."""
BETWEEN = 16.0 / 15.0
"""Largest distance of a smooth surface from a triangle, relative to the largest at its center and midpoints of edges.
To second order the distance is sum d_ij l_i l_j in barycentric coordinates l; the worst case is d = (1, 1, 1/4)."""
TRIES = 8
SAFETY = 0.9
LONGEST = 0.7
"""Largest next cell size, relative to the last."""
MOST = 2**23
"""Most triangles of meshes whose cells are reduced for missed surface; more take minutes and all of the memory."""
LANDED = 1.0e-3
"""Largest distance from the surface, in cells, at which Newton's method counts as converged."""


class Within(NamedTuple):
    """A mesh within a tolerance, the unresolved cells of its grid, and how it was reached."""

    polygons: Polygons
    hidden: Unresolved
    cell: float
    """[m] side of the cells."""
    missed: float
    """[m] the result of ``missed``; above the tolerance if meeting it would take too many triangles."""


def distance(tape: Tape, polygons: Polygons) -> float:
    """The largest distance [m] of the triangles from the surface, estimated at centers and midpoints of edges.

    The distance there is |f| / |grad f|, correct to first order. The factor BETWEEN bounds it, to second order, over a
    triangle on which the surface is smooth; an edge or corner of the solid may be farther. Surface far from all
    triangles is measured by ``missed``. Meshes of more than PROBES triangles are sampled at equal steps.
    """
    triangles = polygons.triangles[:: max(1, len(polygons.triangles) // PROBES)]
    return float(distances_off(tape, polygons.vertices[triangles]).max(initial=0.0))


def distances_off(tape: Tape, corners: Floats) -> Floats:
    """(t,) distances [m] of triangles (t, 3, 3) from the surface, as ``distance`` estimates them."""
    import numpy as np

    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    places = np.concatenate([corners.mean(axis=1)[:, None], middles], axis=1).reshape(-1, 3)
    slopes = np.linalg.norm(many_gradients(tape, places), axis=1)
    off = np.divide(np.abs(field_values(tape, places)), slopes, out=np.zeros(len(places)), where=slopes > 0.0)
    found: Floats = BETWEEN * off.reshape(-1, 4).max(axis=1)
    return found


def missed(tape: Tape, polygons: Polygons, hidden: Unresolved) -> float:
    """The largest distance [m] from the mesh of surface found in unresolved cells, whose corners have one sign.

    Newton's method starts at the centers of these cells; where it converges less than a cell away along each axis, the
    point found is measured, other cells are ignored. More than PROBES cells are sampled at equal steps. Infinite where
    such a point is found, but there is no triangle.
    """
    import numpy as np

    middles, side = hidden.middles[:: max(1, hidden.cells // PROBES)], hidden.grid.cell
    places, slopes = settled(tape, middles)
    with np.errstate(all="ignore"):
        off = np.abs(field_values(tape, places)) / np.linalg.norm(many_gradients(tape, places), axis=1)
        landed = (off < LANDED * side) & (np.abs(places - middles).max(axis=1) < side) & slopes.any(axis=1)
    if not landed.any():
        return 0.0
    if not len(polygons.triangles):
        return float(np.inf)
    from sceneql.mesh.distance import distances

    return float(distances(places[landed], polygons.vertices, polygons.triangles).max())


def polygonise_within(tape: Tape, low: Corner, high: Corner, tolerance: float, cell: float, method: Method) -> Within:
    """A mesh by ``method`` whose ``distance`` is at most ``tolerance`` [m], from cells of side <= ``cell`` [m].

    Its ``missed`` is within the tolerance too, unless that would take more than MOST triangles. The cell size is
    reduced by the measured distance, which is of second order in it, of first order at edges and corners that are not
    kept. Raises ValueError as ``method``, and if TRIES cell sizes do not reach the tolerance.
    """
    import numpy as np

    if not tolerance > 0.0:
        raise ValueError("the tolerance must be above 0")
    whole = bounded(tape, low, high)
    for left in reversed(range(TRIES)):
        polygons, hidden = method(tape, low, high, cell)
        found, unseen = distance(whole, polygons), missed(whole, polygons, hidden)
        # Each hidden cell will give about four triangles, two on each side of a thin wall, times (1 / cell)^2.
        count = len(polygons.triangles) + 4 * hidden.cells * (hidden.grid.cell / cell) ** 2
        shortest = float(np.sqrt(count / MOST))
        if found <= tolerance and (unseen <= tolerance or shortest > LONGEST or not left):
            return Within(polygons, hidden, cell, unseen)
        share = max(0.25, min(LONGEST, SAFETY * float(np.sqrt(tolerance / max(found, unseen)))))
        last, cell = cell, cell * (share if found > tolerance else max(share, shortest))
    raise ValueError(f"{TRIES} cells, the last of {last:g} m, did not come within {tolerance:g} m of the surface")
