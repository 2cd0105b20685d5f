"""Finds triangles that face inward because their mesh folds over or intersects itself. Imports numpy and numba.

The gradient at a triangle's center does not find them: along an edge of the solid, and on walls thinner than a cell, it
is that of another face, and a triangle against it may well separate inside from outside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.repair.flips import facing

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.mesh.polygons import Polygons

    Rows = NDArray[np.int64]

OFF = 1.0e-4
"""Distance from a triangle's center at which its outer side is tested, in square roots of its area."""
TILT = 0.7548776662466927, 0.5698402909980532
"""Slopes of the rays against the axes that meshes follow: no ray runs along a side of a triangle."""
INSIDE = 1.001
"""Side of the grid of squares relative to the extent of the points: none lies on its far border."""


def doubtful(polygons: Polygons) -> Rows:
    """(n,) rows of triangles whose normal disagrees with one of their vertex normals."""
    import numpy as np

    from sceneql.mesh.cubes.triangle_kernels import unlike_corners

    rows = np.empty(len(polygons.triangles), dtype=np.int64)
    return rows[: unlike_corners(polygons.vertices, polygons.triangles, polygons.normals, rows)].copy()


def against(tape: Tape, polygons: Polygons) -> Rows:
    """(n,) rows of triangles whose normal disagrees with a vertex normal and with the gradient at their center."""
    rows = doubtful(polygons)
    found: Rows = rows[facing(tape, polygons.vertices[polygons.triangles[rows]]) < 0.0]
    return found


def folds(tape: Tape, polygons: Polygons) -> Rows:
    """(n,) rows of triangles against the gradient whose outer side is inside the closed mesh."""
    return inverted(polygons, against(tape, polygons))


def inverted(polygons: Polygons, rows: Rows) -> Rows:
    """Those of the rows (n,) of triangles whose outer side is inside the closed mesh."""
    import numpy as np

    if not len(rows):
        return rows
    a, b, c = (polygons.vertices[polygons.triangles[rows, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    sizes = np.linalg.norm(across, axis=1, keepdims=True)
    around = winding((a + b + c) / 3.0 + OFF * across / np.sqrt(sizes), polygons.vertices, polygons.triangles)
    found: Rows = rows[around != 0]
    return found


def winding(points: Floats, places: Floats, triangles: Ints) -> Rows:
    """(n,) winding numbers of a closed surface of triangles (t, 3) around points (n, 3): 1 inside, 0 outside."""
    import numpy as np

    from sceneql.mesh.cubes.triangle_kernels import count_passed

    if not len(points):
        return np.zeros(0, dtype=np.int64)
    # A shear makes the rays parallel to x; it keeps crossings and their signs.
    points, places = (
        np.stack([p[:, 0], p[:, 1] - TILT[0] * p[:, 0], p[:, 2] - TILT[1] * p[:, 0]], axis=-1) for p in (points, places)
    )
    first = points[:, 1:].min(axis=0)
    row = int(np.sqrt(len(points))) + 1
    width = INSIDE * float((points[:, 1:].max(axis=0) - first).max()) / row or 1.0
    squares = ((points[:, 1:] - first) / width).astype(np.int64) @ [1, row]
    order = np.argsort(squares, kind="stable")
    begin = np.searchsorted(squares[order], np.arange(row * row + 1))
    found, around = np.zeros((2, len(points)), dtype=np.int64)
    count_passed(places, triangles, points[order], begin, first, width, row, around)
    found[order] = around
    return found


def extents(corners: Floats) -> tuple[Floats, Floats]:
    """Bounding boxes (least, most), each (t, k), of triangles (t, 3, k)."""
    import numpy as np

    a, b, c = (corners[:, k] for k in range(3))
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
