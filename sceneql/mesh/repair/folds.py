"""Folds: triangles that face inward because the mesh folds over or intersects itself. Imports numpy and numba.

A fold is detected by the mesh's winding number. The gradient at a triangle's center is not enough: along an edge of the
solid, and on walls thinner than a cell, it belongs to another face, and a triangle against it may be correct.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.polygons import touched
from sceneql.mesh.repair.flips import facing

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.mesh.polygons import Polygons

    Rows = NDArray[np.int64]

OFF = 1.0e-4
"""Distance from a triangle's center at which its outer side is tested, in square roots of twice its area."""
TILT = 0.7548776662466927, 0.5698402909980532
"""Slopes dy/dx and dz/dx of the rays, not aligned with the axes, along which sides of triangles tend to lie."""
AGREE = 0.5
"""Cosine of 60 degrees, the largest angle between a triangle's vertex normals on a smooth surface."""
OVER = -0.866
"""Cosine of 150 degrees, the least angle between the normals of a triangle and of its turned over neighbor."""
INSIDE = 1.001
"""Side of the grid of squares relative to the extent of the points, so that none lies on its far border."""


def doubtful(polygons: Polygons) -> Rows:
    """(n,) rows of triangles whose normal disagrees with one of their vertex normals (kernel ``unlike_corners``)."""
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
    """(n,) rows of triangles, those of ``against``, whose outer side lies inside the closed mesh."""
    return inverted(polygons, against(tape, polygons))


def overturned(tape: Tape, polygons: Polygons, rest: Ints | None = None) -> Rows:
    """(n,) rows of ``folds``, ``wrinkles`` and ``turned_over``, the last two where the surface is smooth.

    For meshes without sharp edges: where edges are kept, normals turn at correct triangles, too. ``rest`` (t, 3) are
    the triangles that close the mesh, where ``polygons`` is a part of it.
    """
    import numpy as np

    rows = doubtful(polygons)
    if not len(rows):
        return rows
    facing_in = rows[facing(tape, polygons.vertices[polygons.triangles[rows]]) < 0.0]
    found = np.union1d(inverted(polygons, facing_in, rest), wrinkles(polygons, facing_in))
    return np.union1d(found, turned_over(polygons, rows))


def told(tape: Tape, polygons: Polygons) -> Rows:
    """(n,) rows of ``overturned`` but for walls at which f jumps, where the gradient says nothing of what is outside.

    Repairs take all of them, for these as they are.
    """
    import numpy as np

    rows = overturned(tape, polygons)
    right = np.zeros(len(rows), dtype=bool)
    facing_in = facing(tape, polygons.vertices[polygons.triangles[rows]]) < 0.0
    right[facing_in] = at_jumps(tape, polygons, rows[facing_in])
    return rows[~right]


def at_jumps(tape: Tape, polygons: Polygons, rows: Rows) -> NDArray[np.bool_]:
    """(n,) whether f is negative just inside of triangles ``rows`` (n,) and not just outside: there they face rightly.

    For triangles that face against the gradient: f jumps at them, as at the steps of ``floor``, or they are at an edge.
    """
    import numpy as np

    from sceneql.field.tape.tape_solid import field_values

    a, b, c = (polygons.vertices[polygons.triangles[rows, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    sizes = np.sqrt(np.linalg.norm(across, axis=1, keepdims=True))
    step = OFF * np.divide(across, sizes, out=np.zeros_like(across), where=sizes > 0.0)
    inside, outside = (field_values(tape, (a + b + c) / 3.0 + side * step) for side in (-1.0, 1.0))
    found: NDArray[np.bool_] = (inside < 0.0) & ~(outside < 0.0)
    return found


def wrinkles(polygons: Polygons, rows: Rows) -> Rows:
    """Rows, among ``rows`` (n,), of triangles that face against their three vertex normals, which agree with another.

    The middle layer of a Z-shaped fold has the inside behind it, so the winding number does not detect it; but on a
    smooth surface no correct triangle faces so. At an edge of the solid, and on thin walls, vertex normals disagree.
    """
    import numpy as np

    corners, normals = (of[polygons.triangles[rows]] for of in (polygons.vertices, polygons.normals))
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    agree = (np.einsum("tkj,tkj->tk", normals, np.roll(normals, -1, axis=1)) > AGREE).all(axis=1)
    found: Rows = rows[agree & (np.einsum("tj,tkj->tk", across, normals) < 0.0).all(axis=1)]
    return found


def turned_over(polygons: Polygons, rows: Rows) -> Rows:
    """Rows of triangles turned over against a neighbor: normals beyond OVER, though all vertex normals agree.

    Searched near the triangles ``rows`` (n,); of each pair the triangle farther from its vertex normals is returned.
    """
    import numpy as np

    from sceneql.mesh.repair.flips import Sides

    near = np.zeros(len(polygons.vertices), dtype=bool)
    near[polygons.triangles[rows]] = True
    around = np.flatnonzero(touched(near, polygons.triangles))
    around = around[near[polygons.triangles[around]].sum(axis=1) > 1]
    triangles = polygons.triangles[around].astype(np.int64)
    if not len(triangles):
        return rows
    corners, slopes = polygons.vertices[triangles], polygons.normals[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, sizes, out=np.zeros_like(normals), where=sizes > 0.0)
    means = np.einsum("tj,tkj->t", normals, slopes)
    beside = Sides(triangles, len(polygons.vertices))
    found = []
    for k in range(3):
        a, b = triangles[:, k], triangles[:, (k + 1) % 3]
        other = beside.owners(b, a)
        turned = np.flatnonzero((other >= 0) & (np.einsum("tj,tj->t", normals, normals[other]) < OVER))
        of = np.concatenate([slopes[turned], slopes[other[turned]]], axis=1)
        agree = (np.einsum("tij,tkj->tik", of, of) > 0.0).all(axis=(1, 2))
        found.append(turned[agree & (means[turned] <= means[other[turned]])])
    told: Rows = around[np.unique(np.concatenate(found))]
    return told


def inverted(polygons: Polygons, rows: Rows, rest: Ints | None = None) -> Rows:
    """Rows, among ``rows`` (n,), of triangles whose outer side lies inside the closed mesh, by its winding number.

    ``rest`` (t, 3): further triangles that close it.
    """
    import numpy as np

    if not len(rows):
        return rows
    a, b, c = (polygons.vertices[polygons.triangles[rows, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    sizes = np.linalg.norm(across, axis=1, keepdims=True)
    around = np.zeros(len(rows), dtype=np.int64)
    for triangles in (polygons.triangles,) if rest is None else (polygons.triangles, rest):
        around += winding((a + b + c) / 3.0 + OFF * across / np.sqrt(sizes), polygons.vertices, triangles)
    found: Rows = rows[around != 0]
    return found


def winding(points: Floats, places: Floats, triangles: Ints) -> Rows:
    """(n,) winding numbers of a closed surface of triangles (t, 3) around points (n, 3): 1 inside, 0 outside."""
    import numpy as np

    from sceneql.mesh.cubes.triangle_kernels import count_passed

    if not len(points):
        return np.zeros(0, dtype=np.int64)
    # A shear makes the tilted rays parallel to x, and preserves crossings and their signs.
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
