"""Triangles that face inward of their own mesh: it is folded over, or passes through itself. Imports numpy and numba.

The gradient in a triangle's middle does not tell them: along an edge of the solid, and on walls thinner than a cell,
it is that of another face, and a triangle against it may well part inside from outside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.flips import facing

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape
    from sceneql.mesh.polygons import Polygons

    Rows = NDArray[np.int64]

OFF = 1.0e-4
"""How far from a triangle's middle its outer side is looked at, in square roots of its area."""
TILT = 0.7548776662466927, 0.5698402909980532
"""Of the rays, against the axes that meshes follow: none passes along a side of a triangle."""
AT_ONCE = 2**18
"""Pairs of rays and triangles that are looked at together: so much memory is enough for a field of noise, too."""


def doubtful(polygons: Polygons) -> Rows:
    """(n,) rows of triangles that do not face as the normals of all their corners do."""
    import numpy as np

    a, b, c = (polygons.vertices[polygons.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    along = [np.einsum("tj,tj->t", across, polygons.normals[polygons.triangles[:, k]]) for k in range(3)]
    return np.flatnonzero(np.minimum.reduce(along) <= 0.0)


def against(tape: Tape, polygons: Polygons) -> Rows:
    """(n,) rows of triangles that do not face as their corners do and face against the gradient in their middle."""
    rows = doubtful(polygons)
    found: Rows = rows[facing(tape, polygons.vertices[polygons.triangles[rows]]) < 0.0]
    return found


def folds(tape: Tape, polygons: Polygons) -> Rows:
    """(n,) rows of triangles against the gradient whose outer side is not outside of the closed mesh."""
    return inverted(polygons, against(tape, polygons))


def inverted(polygons: Polygons, rows: Rows) -> Rows:
    """Those of the rows (n,) of triangles whose outer side is not outside of the closed mesh."""
    import numpy as np

    if not len(rows):
        return rows
    corners = polygons.vertices[polygons.triangles]
    a, b, c = (corners[rows, k] for k in range(3))
    across = np.cross(b - a, c - a)
    sizes = np.linalg.norm(across, axis=1, keepdims=True)
    around = winding((a + b + c) / 3.0 + OFF * across / np.sqrt(sizes), corners)
    found: Rows = rows[around != 0]
    return found


def winding(points: Floats, corners: Floats) -> Rows:
    """(n,) how often the closed surface of triangles (t, 3, 3) goes around points (n, 3): 1 inside, 0 outside.

    The triangles that a ray passes, counted by the side that it leaves by. Those that it may pass are looked up by
    squares across it, as wide as the largest triangle.
    """
    import numpy as np

    found = np.zeros(len(points), dtype=np.int64)
    if not len(points):
        return found
    # Sheared, the rays go along x: what is crossed, and by which side, stays.
    points, corners = (
        np.stack([p[..., 0], p[..., 1] - TILT[0] * p[..., 0], p[..., 2] - TILT[1] * p[..., 0]], axis=-1)
        for p in (points, corners)
    )
    least, most = extents(corners[:, :, 1:])
    width = (most - least).max()
    first = least.min(axis=0) - width
    squares, wanted = (np.floor((p - first) / width).astype(np.int64) for p in (least, points[:, 1:]))
    row = max(squares[:, 1].max(), wanted[:, 1].max()) + 2
    numbers = squares @ [row, 1]
    around = [(wanted - [i, j]) @ [row, 1] for i in (0, 1) for j in (0, 1)]
    near = np.flatnonzero(np.isin(numbers, np.concatenate(around)))
    near = near[np.argsort(numbers[near], kind="stable")]
    corners, numbers = corners[near], numbers[near]
    least, most = extents(corners)
    for sought in around:
        begin, end = (np.searchsorted(numbers, sought, side) for side in ("left", "right"))
        pairs = np.concatenate([[0], np.cumsum(end - begin)])
        start = 0
        while start < len(points):
            stop = max(start + 1, int(np.searchsorted(pairs, pairs[start] + AT_ONCE, "right")) - 1)
            counts = (end - begin)[start:stop]
            of = np.repeat(np.arange(start, stop), counts)
            at = np.arange(pairs[start], pairs[stop]) + np.repeat((begin - pairs[:-1])[start:stop], counts)
            ahead = (most[at] >= points[of]).all(axis=1) & (least[at, 1:] <= points[of, 1:]).all(axis=1)
            of, at = of[ahead], at[ahead]
            np.add.at(found, of, _passed(points[of], corners[at]))
            start = stop
    return found


def extents(corners: Floats) -> tuple[Floats, Floats]:
    """(least, most), each (t, k), of the coordinates of triangles (t, 3, k)."""
    import numpy as np

    a, b, c = (corners[:, k] for k in range(3))
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def _passed(points: Floats, corners: Floats) -> Rows:
    """(n,) 1 where the ray from a point along x leaves by the triangle, -1 where it enters, 0 where it misses it."""
    import numpy as np

    x, y, z = (corners[:, :, k] - points[:, None, k] for k in range(3))
    # Of each corner, the area of the triangle between the other two and the ray.
    shares = np.roll(y, -1, axis=1) * np.roll(z, 1, axis=1) - np.roll(y, 1, axis=1) * np.roll(z, -1, axis=1)
    side = np.where((shares > 0.0).all(axis=1), 1, np.where((shares < 0.0).all(axis=1), -1, 0))
    return np.where((shares * x).sum(axis=1) * side > 0.0, side, 0)
