"""Folds of marching cubes' meshes: vertices move along the surface, edges are flipped, the last ones collapsed.

Imports numpy and numba.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sceneql.mesh.polygons import Polygons, touched
from sceneql.mesh.repair.collapse import collapsed
from sceneql.mesh.repair.flips import faced_outward
from sceneql.mesh.repair.folds import overturned
from sceneql.mesh.repair.move_vertices import settled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Tape

    Rows = NDArray[np.int64]

ROUNDS = 12
WIDENED = 3
"""Rounds after which the vertices one ring farther out are moved too."""
RINGS = ROUNDS // WIDENED + 2
"""Rings around folds that are looked at: those that move in the last round, and one of triangles on either side."""
MOST = 2**10
"""Most folds for which vertices are moved; more arise from a field too fine for its cells."""


def unfolded(tape: Tape, polygons: Polygons) -> Polygons:
    """The mesh with vertices at folds moved along the surface to the means of their neighbors, and edges flipped.

    Edges of the folds that the best of ROUNDS rounds leaves are collapsed. Nothing of it changes the topology; some
    folds may stay.
    """
    import numpy as np

    rows = overturned(tape, polygons)
    if not 0 < len(rows) <= MOST:
        return replace(polygons, unfolded=not len(rows))
    near = np.zeros(len(polygons.vertices), dtype=bool)
    near[polygons.triangles[rows]] = True
    for _ in range(RINGS):
        near[polygons.triangles[touched(near, polygons.triangles)]] = True
    part = touched(near, polygons.triangles)
    some, rest = polygons.triangles[part], polygons.triangles[~part]
    found = Polygons(polygons.vertices, some, polygons.normals)
    rows = (np.cumsum(part) - 1)[rows]
    best, best_rows = found, rows
    outer = np.zeros(len(polygons.vertices), dtype=bool)
    outer[rest] = True
    for turn in range(ROUNDS):
        near[:] = False
        near[found.triangles[rows]] = True
        for _ in range(turn // WIDENED):
            near[found.triangles[touched(near, found.triangles)]] = True
        found = _relaxed(tape, found, near, outer)
        rows = overturned(tape, found, rest)
        if len(rows) < len(best_rows):
            best, best_rows = found, rows
        if not 0 < len(rows) <= MOST:
            break
    best = collapsed(tape, best, best_rows, rest)
    if len(best.triangles) == len(some):
        triangles = polygons.triangles.copy()
        triangles[part] = best.triangles
        return Polygons(best.vertices, triangles, best.normals)
    triangles = np.concatenate([rest, best.triangles])
    used = np.zeros(len(best.vertices), dtype=bool)
    used[triangles] = True
    return Polygons(best.vertices[used], (np.cumsum(used) - 1)[triangles].astype(np.int32), best.normals[used])


def _relaxed(tape: Tape, polygons: Polygons, chosen: NDArray[np.bool_], outer: NDArray[np.bool_]) -> Polygons:
    """The mesh with the vertices of the mask ``chosen`` (v,) moved, and edges near them flipped.

    ``outer`` (v,): the vertices of triangles that are left out.
    """
    import numpy as np

    triangles = polygons.triangles.astype(np.int64)
    star = triangles[touched(chosen, triangles)]
    corners = np.flatnonzero(chosen & polygons.normals.any(axis=1))
    ends = np.unique(star[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=0)
    ends = ends[np.isin(ends[:, 0], corners)]
    at = np.searchsorted(corners, ends[:, 0])
    places, normals = polygons.vertices.copy(), polygons.normals.copy()
    middles, reach = np.zeros((len(corners), 3)), np.zeros(len(corners))
    np.add.at(middles, at, places[ends[:, 1]])
    np.maximum.at(reach, at, np.linalg.norm(places[ends[:, 1]] - places[ends[:, 0]], axis=1))
    middles /= np.bincount(at, minlength=len(corners))[:, None]
    new, slopes = settled(tape, middles, reach)
    kept = slopes.any(axis=1)
    places[corners[kept]], normals[corners[kept]] = new[kept], slopes[kept]
    rows = np.flatnonzero(touched(chosen, triangles))
    flipped = faced_outward(tape, Polygons(places, polygons.triangles, normals), rows, outer)
    return Polygons(places, flipped, normals)
