"""Folds removed by collapsing an edge, where no move of vertices and no flip removes them. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.flips import agreement
from sceneql.mesh.repair.folds import overturned

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Rows = NDArray[np.int64]

SIDES = [[0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2]]
"""Corners of a triangle that are kept, and that go, by its six edges collapsed."""
FEW = 64
"""Most folds of which edges are collapsed."""
LONGER = 1.5
"""Most by which a collapse lengthens the longest side around it."""


def collapsed(tape: Tape, polygons: Polygons, folds: Rows, rest: Ints) -> Polygons:
    """The mesh, closed by triangles ``rest`` (t, 3), with edges at ``folds`` (n,) collapsed while that leaves fewer.

    Edges that the link condition forbids are kept, so that the topology is (Dey, Edelsbrunner, Guha, Nekhayev 1999).
    """
    import numpy as np

    outer = np.zeros(len(polygons.vertices), dtype=bool)
    outer[rest] = True
    while 0 < len(folds) <= FEW:
        triangles = polygons.triangles.copy()
        for row in folds.tolist():
            triangles = _without(tape, polygons, triangles, row, outer)
        found = Polygons(polygons.vertices, triangles[triangles[:, 0] != triangles[:, 1]], polygons.normals)
        left = overturned(tape, found, rest)
        if len(left) >= len(folds):
            break
        polygons, folds = found, left
    return Polygons(polygons.vertices, np.ascontiguousarray(polygons.triangles), polygons.normals)


def _without(tape: Tape, polygons: Polygons, triangles: Ints, row: int, outer: NDArray[np.bool_]) -> Ints:
    """The triangles (t, 3) with one edge at triangle ``row`` collapsed, where fewer around it then face inward.

    An edge of it, or of a triangle beside it, at no vertex of the mask ``outer`` (v,), which has other triangles, too.
    Triangles that vanish have three times the same vertex.
    """
    import numpy as np

    if triangles[row, 0] == triangles[row, 1]:
        return triangles
    beside = np.isin(triangles, triangles[row]).sum(axis=1) > 1
    best, most = triangles, (0, 0.0)
    for keep, gone in np.unique(triangles[beside][:, SIDES].reshape(-1, 2), axis=0).tolist():
        if outer[keep] or outer[gone]:
            continue
        around = np.flatnonzero((triangles == gone).any(axis=1))
        others = triangles[(triangles == keep).any(axis=1)]
        both = (triangles[around] == keep).any(axis=1)
        if both.sum() != 2 or len(np.intersect1d(triangles[around], others)) != 4:
            continue  # more in common than the two ends and the vertices opposite of the edge
        if both.all():
            continue  # two triangles back to back, of which nothing would be left
        moved = np.where(triangles[around[~both]] == gone, keep, triangles[around[~both]])
        before, after = (agreement(tape, polygons, corners) for corners in (triangles[around], moved))
        gain = int((before < 0.0).sum() - (after < 0.0).sum()), float(after.min(initial=1.0))
        reach = _longest(polygons.vertices[np.concatenate([triangles[around], others])])
        if gain > most and gain[0] > 0 and _longest(polygons.vertices[moved]) < LONGER * reach:
            best, most = np.where(triangles == gone, keep, triangles), gain
            best[around[both]] = keep
    return best


def _longest(corners: Floats) -> float:
    """The longest side of triangles (t, 3, 3) [m]."""
    import numpy as np

    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
