"""Dual polygons that fold over, or pass through others, put right by their corners. Imports numpy, numba and scipy.

Corners on an edge of the solid may have passed one another: they are moved along it. Where sheets are nearer to each
other than cells tell, or corners left their cells for an edge outside, they go back towards the means of what the
surface crosses of their cells' edges: there polygons, halved as they face along their edges, were met in no fold.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import many_gradients
from sceneql.mesh.dual.halves import halved
from sceneql.mesh.dual.planes import onto_planes
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.folds import against, doubtful, inverted
from sceneql.mesh.repair.move_vertices import turned_outward
from sceneql.mesh.repair.self_intersections import self_intersections

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Rows = NDArray[np.int64]

SLIDES = 2
"""Rounds in which corners move along the surface and its edges; after them they are drawn off these."""
ROUNDS = 24
RETRIES = 8
BESIDE = 2
"""Rings of triangles around those that pass through others, in which none is turned: flips go from one to the next."""
MOST = 2**18
"""Triangles against the gradient among which folds are looked for, so that fields much too fine for their cells do not
take forever."""
FARTHEST = 0.7
"""Of the corners of triangles that pass through each other those are drawn that are off their means by so many times
the most of them."""
WITHIN = 0.02
"""Of a cell, how far from its faces a corner is put that comes back to it."""
NEAR = 0.15
"""Of a cell, how near to its mean a corner is put there."""


@dataclass(frozen=True, slots=True, eq=False)
class Dual:
    """Quads around crossed edges, and what their corners are of."""

    tape: Tape
    quads: Ints
    """(q, 4)"""
    ways: Ints
    """(q,) axes 1 to 3 of the edges that they go around, below 0 where outward is against the axis."""
    rings: Ints
    """(v, 12) the crossed edges around each corner, -1 after the last."""
    crossings: Floats
    """(e, 3) [m]"""
    slopes: Floats
    """(e, 3) unit gradients there, or zero."""
    means: Floats
    """(v, 3) [m] of each corner's crossings."""
    lows: Floats
    """(v, 3) [m] the first node of its cell."""
    cell: float
    """[m]"""


def repair_folds(dual: Dual, polygons: Polygons) -> Polygons:
    """The polygons, whose first triangles are the halves of the dual's quads, with corners moved until none folds.

    Vertices that follow on the dual's corners stay.
    """
    import numpy as np

    places, normals, triangles = polygons.vertices.copy(), polygons.normals.copy(), polygons.triangles.copy()
    for turn in range(ROUNDS):
        found = Polygons(places, triangles, normals)
        if not len(rows := inverted(found, against(dual.tape, found)[:MOST])):
            break
        if turn < SLIDES:
            moved = _slid(dual, found, rows)
        else:
            moved = _drawn(dual, found, rows)
            normals[moved] = 0.0
        near = np.zeros(len(places), dtype=bool)
        near[moved] = True
        stale = np.flatnonzero(near[dual.quads].any(axis=1))
        halves = halved(dual.tape, places, dual.quads[stale], dual.ways[stale])
        triangles[(2 * stale[:, None] + [0, 1]).ravel()] = halves
    return Polygons(places, triangles, normals)


def _slid(dual: Dual, polygons: Polygons, rows: Rows) -> Rows:
    """Move corners of some triangles halfway to the middles of their neighbors, along the surface: which they are."""
    import numpy as np

    places, triangles = polygons.vertices, polygons.triangles
    corners = np.unique(triangles[rows]).astype(np.int64)
    corners = corners[corners < len(dual.rings)]
    near = np.zeros(len(places), dtype=bool)
    near[corners] = True
    star = triangles[near[triangles].any(axis=1)]
    # Each side of a closed mesh is met in both directions.
    ends = star[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    ends = np.unique(ends, axis=0)
    ends = ends[near[ends[:, 0]]]
    at = np.searchsorted(corners, ends[:, 0])
    middles = np.zeros((len(corners), 3))
    np.add.at(middles, at, places[ends[:, 1]])
    middles /= np.bincount(at, minlength=len(corners))[:, None]
    rings = dual.rings[corners]
    new = onto_planes(
        dual.tape, 0.5 * (places[corners] + middles), rings >= 0, dual.crossings[rings], dual.slopes[rings]
    )
    close = np.abs(new - dual.means[corners]).max(axis=1) < 2.0 * dual.cell
    places[corners[close]] = new[close]
    smooth = corners[polygons.normals[corners].any(axis=1)]
    slopes = many_gradients(dual.tape, places[smooth])
    sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
    polygons.normals[smooth] = np.divide(
        slopes, sizes, out=np.zeros_like(slopes), where=(sizes > 0.0) & (sizes < np.inf)
    )
    return corners


def _drawn(dual: Dual, polygons: Polygons, rows: Rows) -> Rows:
    """Bring the farthest corners of folded triangles, and of those that pass through them, nearer to their means.

    First back to their cells, then by halves. Where all are at their means, those of the triangles beside are drawn.
    """
    import numpy as np

    places, triangles = polygons.vertices, polygons.triangles
    count = len(dual.rings)
    off = np.zeros(len(places))
    off[:count] = np.linalg.norm(places[:count] - dual.means, axis=1)
    first, other = self_intersections(places, triangles, rows)
    first, other = np.concatenate([rows, first]), np.concatenate([rows, other])
    most = np.zeros(len(triangles))
    np.maximum.at(most, first, off[triangles[other]].max(axis=1))
    if not most[rows].any():
        near = np.zeros(len(places), dtype=bool)
        near[triangles[other]] = True
        first = other = np.flatnonzero(near[triangles].any(axis=1))
        most[first] = off[triangles[first]].max(axis=1)
    far = np.maximum(FARTHEST * most[first], 1e-9 * dual.cell)
    corners = np.unique(np.extract(off[triangles[other]] >= far[:, None], triangles[other])).astype(np.int64)
    at, means = places[corners], dual.means[corners]
    low = dual.lows[corners]
    inside = np.clip(at, low + WITHIN * dual.cell, low + (1.0 - WITHIN) * dual.cell)
    home = (np.abs(inside - at) < 1e-9 * dual.cell).all(axis=1, keepdims=True)
    new = np.where(home, 0.5 * (at + means), inside)
    small = np.linalg.norm(new - means, axis=1) < NEAR * dual.cell
    places[corners] = np.where(small[:, None], means, new)
    return corners


def repair_turned(tape: Tape, polygons: Polygons) -> Polygons:
    """The polygons with triangles that face inward put right as by ``turned_outward``, but where that folds others.

    At edges of the solid, and on sheets nearer to each other than cells tell, the gradient is of another face.
    """
    import numpy as np

    rows = doubtful(polygons)
    if not len(rows):
        return polygons
    near = np.zeros(len(polygons.vertices), dtype=bool)
    for _ in range(RETRIES):
        turned = turned_outward(tape, polygons, rows)
        folded = against(tape, turned)
        if len(folded) > MOST or not len(folded := inverted(turned, folded)):
            return turned
        near[turned.triangles[folded]] = True
        near[turned.triangles[self_intersections(turned.vertices, turned.triangles, folded)[1]]] = True
        for _ in range(BESIDE):
            near[polygons.triangles[near[polygons.triangles].any(axis=1)]] = True
        rows = rows[~near[polygons.triangles[rows]].any(axis=1)]
    return polygons
