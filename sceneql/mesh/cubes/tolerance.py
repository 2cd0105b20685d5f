"""Cells short enough for a tolerance of the distance between the triangles and the surface. Imports numpy and numba."""

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
"""Triangles at which a distance is measured."""
BETWEEN = 16.0 / 15.0
"""Largest distance of a smooth surface from a triangle relative to that at its center and the middles of its edges: it
is sum d_ij l_i l_j in barycentric coordinates, whose maximum is off these places for d = (1, 1, 1/4)."""
TRIES = 8
SAFETY = 0.9
LONGEST = 0.7
"""Longest next cell, relative to the last."""
MOST = 2**23
"""Triangles up to which cells are shortened for missed surface; more take minutes and all of the memory."""
LANDED = 1.0e-3
"""Largest distance from the surface, in cells, of a point that Newton's method has brought onto it."""


class Within(NamedTuple):
    """Triangles within a tolerance, and the cells that made them."""

    polygons: Polygons
    hidden: Unresolved
    cell: float
    """[m]"""
    missed: float
    """[m] as of ``missed``; above the tolerance if a smaller one takes too many cells."""


def distance(tape: Tape, polygons: Polygons) -> float:
    """The largest distance [m] of the triangles from the surface, by their centers and the middles of their edges.

    There it is |f| / |grad f|, right to first order; BETWEEN them a surface that is smooth across a triangle is nearer
    to second order, one with an edge or a corner there may be farther. Surface without a triangle near it, as a piece
    missed by all cells, is left to ``missed``. Of more than PROBES triangles only every so many-th is measured.
    """
    triangles = polygons.triangles[:: max(1, len(polygons.triangles) // PROBES)]
    return float(distances_off(tape, polygons.vertices[triangles]).max(initial=0.0))


def distances_off(tape: Tape, corners: Floats) -> Floats:
    """(t,) distances [m] of triangles (t, 3, 3), as by ``distance``."""
    import numpy as np

    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    places = np.concatenate([corners.mean(axis=1)[:, None], middles], axis=1).reshape(-1, 3)
    slopes = np.linalg.norm(many_gradients(tape, places), axis=1)
    off = np.divide(np.abs(field_values(tape, places)), slopes, out=np.zeros(len(places)), where=slopes > 0.0)
    found: Floats = BETWEEN * off.reshape(-1, 4).max(axis=1)
    return found


def missed(tape: Tape, polygons: Polygons, hidden: Unresolved) -> float:
    """The largest distance [m] from the triangles of surface that passes between the corners of unresolved cells.

    Newton's method from the middles of these cells finds it; cells from which it does not end in the cell or next to it
    are left to ``Unresolved``. Of more than PROBES cells only every so many-th is tried. Infinite where there is
    surface, but no triangle.
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
    """Triangles within ``tolerance`` [m] of the surface, as by ``distance``, from cells [m] <= ``cell``.

    And the surface within it of the triangles, as by ``missed``, unless that takes more than MOST triangles. The
    distance falls with the square of the cell, at edges and corners that are not kept with the cell itself: the cell is
    shortened by the measured distance. Raises ValueError as ``method``, and if TRIES cells do not reach the tolerance.
    """
    import numpy as np

    if not tolerance > 0.0:
        raise ValueError("the tolerance must be above 0")
    whole = bounded(tape, low, high)
    for left in reversed(range(TRIES)):
        polygons, hidden = method(tape, low, high, cell)
        found, unseen = distance(whole, polygons), missed(whole, polygons, hidden)
        # A wall thinner than a cell will have two triangles on either side; they grow with the square of 1 / cell.
        count = len(polygons.triangles) + 4 * hidden.cells * (hidden.grid.cell / cell) ** 2
        shortest = float(np.sqrt(count / MOST))
        if found <= tolerance and (unseen <= tolerance or shortest > LONGEST or not left):
            return Within(polygons, hidden, cell, unseen)
        share = max(0.25, min(LONGEST, SAFETY * float(np.sqrt(tolerance / max(found, unseen)))))
        last, cell = cell, cell * (share if found > tolerance else max(share, shortest))
    raise ValueError(f"{TRIES} cells, the last of {last:g} m, did not come within {tolerance:g} m of the surface")
