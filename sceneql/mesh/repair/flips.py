"""Edge flips that turn inward facing triangles outward. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import many_gradients
from sceneql.mesh.cubes.triangle_kernels import least_cosines
from sceneql.mesh.polygons import touched
from sceneql.mesh.repair.move_kernels import SLIVER

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.mesh.polygons import Polygons

    Rows = NDArray[np.int64]

ROUNDS = 8


def faced_outward(tape: Tape, polygons: Polygons, doubtful: Rows, outer: NDArray[np.bool_] | None = None) -> Ints:
    """The triangles (t, 3) with edges flipped where one of the rows ``doubtful`` (n,) faces inward by ``agreement``.

    The edge of two triangles is replaced by the other diagonal of their four vertices if that raises the smaller
    agreement of the two, and is no edge of the mesh yet: a closed 2-manifold stays one. ``outer`` (v,) marks vertices
    of triangles that are not among these: of those between two of them it is not known whether they are edges.
    """
    import numpy as np

    found = polygons.triangles.astype(np.int64)
    for _ in range(ROUNDS):
        turned = doubtful[inward(tape, polygons, found[doubtful])]
        near = np.zeros(len(polygons.vertices), dtype=bool)
        near[found[turned]] = True
        around = np.flatnonzero(touched(near, found))
        changed = _flipped(tape, polygons, found[around], np.searchsorted(around, turned), outer)
        if not changed:
            break
        for at, row in changed.items():
            found[around[at]] = row
        # Of a triangle none of whose vertices are in a changed one, nothing is new.
        rows = around[list(changed)]
        near[:] = False
        near[found[rows]] = True
        doubtful = np.union1d(turned[touched(near, found[turned])], rows)
    return found.astype(np.int32)


def facing(tape: Tape, corners: Floats) -> Floats:
    """(t,) cosine of the angle between the normals of triangles (t, 3, 3) and the gradients at their centers.

    0 where the gradient vanishes, and for a triangle thinner than SLIVER, as along a sharp edge.
    """
    import numpy as np

    a, b, c = (corners[:, k] for k in range(3))
    normals, slopes = np.cross(b - a, c - a), many_gradients(tape, (a + b + c) / 3.0)
    areas = np.linalg.norm(normals, axis=1)
    sizes = areas * np.linalg.norm(slopes, axis=1)
    longest = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=2).max(axis=1)
    dots = np.einsum("tj,tj->t", normals, slopes)
    cosines: Floats = np.divide(dots, sizes, out=np.zeros_like(dots), where=(sizes > 0.0) & (areas > SLIVER * longest))
    return cosines


def agreement(tape: Tape, polygons: Polygons, triangles: NDArray[np.integer]) -> Floats:
    """(t,) how well triangles (t, 3) of the mesh's vertices face outward: the greater of two cosines.

    Of ``facing``, and of the least between the triangle's normal and those of its vertices, if all have one: along an
    edge of the solid, and on thin walls, the gradient at the center of a correct triangle belongs to another face.
    """
    import numpy as np

    least = _by_vertices(polygons, triangles)
    found: Floats = np.maximum(facing(tape, polygons.vertices[triangles]), least)
    return found


def inward(tape: Tape, polygons: Polygons, triangles: NDArray[np.integer]) -> NDArray[np.bool_]:
    """(t,) whether the ``agreement`` of triangles (t, 3) is below 0; the tape is asked only where normals do not tell.

    Their normals tell of most that they face outward.
    """
    found: NDArray[np.bool_] = _by_vertices(polygons, triangles) < 0.0
    found[found] = facing(tape, polygons.vertices[triangles[found]]) < 0.0
    return found


def _by_vertices(polygons: Polygons, triangles: NDArray[np.integer]) -> Floats:
    """(t,) the least cosine between normals of triangles (t, 3) and of their vertices; -1 where one has none."""
    import numpy as np

    least: Floats = np.empty(len(triangles))
    least_cosines(polygons.vertices, np.ascontiguousarray(triangles, dtype=np.int64), polygons.normals, least)
    return least


def _flipped(
    tape: Tape, polygons: Polygons, triangles: Rows, turned: Rows, outer: NDArray[np.bool_] | None
) -> dict[int, tuple[int, int, int]]:
    """New vertices of flipped triangles, by row of ``triangles`` (t, 3): the best flips of the triangles ``turned``.

    ``triangles`` must contain all triangles at the vertices of the turned ones. No triangle is flipped twice.
    """
    import numpy as np

    # Vertices c and d lie opposite the side a b, in a turned triangle and in its neighbor.
    a, b, c = (np.roll(triangles[turned], -k, axis=1).ravel() for k in range(3))
    at = np.repeat(turned, 3)
    sides = Sides(triangles, len(polygons.vertices))
    other = sides.owners(b, a)
    paired = other >= 0
    a, b, c, at, other = a[paired], b[paired], c[paired], at[paired], other[paired]
    d = triangles[other].sum(axis=1) - a - b
    free = (c != d) & (sides.owners(c, d) < 0) & (sides.owners(d, c) < 0)
    if outer is not None:
        free &= ~(outer[c] & outer[d])
    a, b, c, d, at, other = a[free], b[free], c[free], d[free], at[free], other[free]
    if not len(a):
        return {}
    old = triangles[np.stack([at, other], axis=1).ravel()]
    new = np.stack([np.stack([c, a, d], axis=1), np.stack([d, b, c], axis=1)], axis=1).reshape(-1, 3)
    told = [agreement(tape, polygons, corners) for corners in (old, new)]
    gains = np.subtract(*(cosines.reshape(-1, 2).min(axis=1) for cosines in told[::-1]))
    # A sliver that faces inward is better than a large triangle that does.
    wrong = [_areas(polygons, of, cosines < 0.0) for of, cosines in zip((old, new), told, strict=True)]
    gains[wrong[1] > wrong[0]] = 0.0
    changed: dict[int, tuple[int, int, int]] = {}
    edges: set[frozenset[int]] = set()
    best = np.argsort(-gains, kind="stable")
    best = best[gains[best] > 0.0]
    for rows, first, second in zip(
        np.stack([at, other], axis=1)[best].tolist(), new[2 * best].tolist(), new[2 * best + 1].tolist(), strict=True
    ):
        edge = frozenset((first[0], first[2]))
        if rows[0] not in changed and rows[1] not in changed and edge not in edges:
            changed |= {rows[0]: tuple(first), rows[1]: tuple(second)}
            edges.add(edge)
    return changed


def _areas(polygons: Polygons, triangles: Rows, chosen: NDArray[np.bool_]) -> Floats:
    """(n,) twice the areas of pairs of triangles (2 n, 3), of the ``chosen`` (2 n,) alone [m^2]."""
    import numpy as np

    a, b, c = polygons.vertices[triangles].transpose(1, 0, 2)
    found: Floats = (np.linalg.norm(np.cross(b - a, c - a), axis=1) * chosen).reshape(-1, 2).sum(axis=1)
    return found


class Sides:
    """Look-up of triangles (t, 3) by a directed side."""

    def __init__(self, triangles: Rows, vertices: int) -> None:
        import numpy as np

        keys = (triangles * vertices + np.roll(triangles, -1, axis=1)).ravel()
        self._order, self._vertices = np.argsort(keys), vertices
        self._ascending = keys[self._order]

    def owners(self, first: Rows, last: Rows) -> Rows:
        """(n,) the triangle with the directed side from ``first`` (n,) to ``last`` (n,); -1 where there is none."""
        import numpy as np

        keys = first * self._vertices + last
        at = np.minimum(np.searchsorted(self._ascending, keys), len(self._ascending) - 1)
        found: Rows = np.where(self._ascending[at] == keys, self._order[at] // 3, -1)
        return found
