"""Folds and self-intersections of dual contouring's mesh, repaired by moving vertices. Imports numpy, numba and scipy.

First, vertices slide along the surface and its edges, where they may have passed one another. Then vertices of folds
are pulled towards the mean of the crossings on their cell's edges: this helps where sheets are nearer than a cell, or
where a vertex left its cell for an edge outside. With all vertices at their means no fold has been observed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import many_gradients
from sceneql.mesh.dual.halves import halved
from sceneql.mesh.dual.planes import onto_planes
from sceneql.mesh.polygons import Polygons, touched
from sceneql.mesh.repair.folds import against, doubtful, inverted
from sceneql.mesh.repair.move_vertices import turned_outward
from sceneql.mesh.repair.self_intersections import self_intersections

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Rows = NDArray[np.int64]

SLIDES = 2
"""Rounds in which vertices slide along the surface and its edges; in later rounds they are pulled off these."""
ROUNDS = 24
RETRIES = 8
BESIDE = 2
"""Rings of triangles around self-intersections in which no edge is flipped, since flips spread to neighbors."""
MOST = 2**18
"""Most triangles against the gradient that are tested for folds: a limit for fields much too fine for their cells."""
FARTHEST = 0.7
"""A vertex of intersecting triangles is pulled if its distance from its mean is at least this share of the largest such
distance among their vertices."""
WITHIN = 0.02
"""Distance from the faces of its cell, in cells, to which a vertex outside the cell is moved."""
NEAR = 0.15
"""Distance from its mean, in cells, below which a vertex is put onto the mean."""


@dataclass(frozen=True, slots=True, eq=False)
class Dual:
    """Dual contouring's quads around crossed grid edges, with the data of their vertices."""

    tape: Tape
    quads: Ints
    """(q, 4) dual vertices."""
    ways: Ints
    """(q,) axes 1 to 3 of the crossed edges, negative where outward is against the axis."""
    rings: Ints
    """(v, 12) the crossed edges around each vertex, -1 after the last."""
    crossings: Floats
    """(e, 3) [m] where the surface crosses grid edges."""
    slopes: Floats
    """(e, 3) unit gradients at the crossings, or zero."""
    means: Floats
    """(v, 3) [m] mean of the crossings in each vertex's ring."""
    lows: Floats
    """(v, 3) [m] lowest corner of each vertex's cell."""
    cell: float
    """[m] side of a cell."""


def repair_folds(dual: Dual, polygons: Polygons) -> Polygons:
    """The mesh with vertices moved until no triangle folds, for at most ROUNDS rounds.

    Its first triangles are the halved quads of ``dual``. Only dual vertices, which come first, are moved.
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
        stale = np.flatnonzero(touched(near, dual.quads))
        halves = halved(dual.tape, places, dual.quads[stale], dual.ways[stale])
        triangles[(2 * stale[:, None] + [0, 1]).ravel()] = halves
    return Polygons(places, triangles, normals)


def _slid(dual: Dual, polygons: Polygons, rows: Rows) -> Rows:
    """Move the vertices of the triangles ``rows`` halfway to the mean of their neighbors, then onto their planes.

    Changes the arrays of ``polygons`` and returns the vertices.
    """
    import numpy as np

    places, triangles = polygons.vertices, polygons.triangles
    corners = np.unique(triangles[rows]).astype(np.int64)
    corners = corners[corners < len(dual.rings)]
    near = np.zeros(len(places), dtype=bool)
    near[corners] = True
    star = triangles[touched(near, triangles)]
    # A closed mesh has each side in both directions, so the sides that begin at a vertex reach all its neighbors.
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
    """Pull vertices of the folds ``rows`` and of triangles that intersect them towards their means; returns them.

    Only the vertices farthest from their means (FARTHEST): first back into their cells, then by half the distance. If
    all are at their means, the vertices of neighboring triangles are pulled instead. Changes ``polygons``.
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
        first = other = np.flatnonzero(touched(near, triangles))
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
    """The mesh with inward facing triangles repaired by ``turned_outward``, except where the repair makes folds.

    It may, since at edges of the solid, and on sheets nearer than a cell, the gradient belongs to another face.
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
            near[polygons.triangles[touched(near, polygons.triangles)]] = True
        rows = rows[~touched(near, polygons.triangles[rows])]
    return polygons
