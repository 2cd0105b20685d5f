"""Moves of vertices that turn inward facing triangles outward where no edge flip does. Imports numpy and numba."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import field_values, many_gradients, scratch
from sceneql.mesh.polygons import Polygons, touched
from sceneql.mesh.repair.flips import faced_outward, inward
from sceneql.mesh.repair.move_kernels import STEPS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Rows = NDArray[np.int64]

ROUNDS = 8
MOST = 256
"""Most inward facing triangles for which vertices are moved; more arise from a field too fine for its cells."""
SHARES = (0.25, 0.5, 0.75, 1.0)
"""Fractions of a vertex's way to the mean of its neighbors that are tried."""


def settled(tape: Tape, begun: Floats, reach: Floats | float = inf) -> tuple[Floats, Floats]:
    """Points (n, 3) moved to the surface by Newton's method along the gradient, and the unit gradients there.

    Points that would move farther than ``reach`` [m], a number or (n,), stay: at a jump of f the method diverges.
    """
    import numpy as np

    places = begun
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            slopes = many_gradients(tape, places)
            moves = (field_values(tape, places) / (slopes**2).sum(axis=1))[:, None] * slopes
            places = places - np.where(np.isfinite(moves).all(axis=1)[:, None], moves, 0.0)
        near = np.linalg.norm(places - begun, axis=1) <= reach
        places = np.where(near[:, None], places, begun)
        slopes = many_gradients(tape, places)
        slopes /= np.linalg.norm(slopes, axis=1, keepdims=True)
    return places, np.where(np.isfinite(slopes), slopes, 0.0)


def turned_outward(tape: Tape, polygons: Polygons, doubtful: Rows) -> Polygons:
    """The mesh with inward facing triangles of the rows ``doubtful`` (n,) repaired: by edge flips, then by moves.

    A vertex moves along the surface towards the mean of its neighbors if that raises the smallest cosine between a
    normal of its triangles and the gradient. Vertices without a normal, on edges of the solid, stay.
    """
    import numpy as np

    places, normals = polygons.vertices.copy(), polygons.normals.copy()
    triangles = faced_outward(tape, polygons, doubtful)
    found = Polygons(places, triangles, normals)
    near = np.zeros(len(places), dtype=bool)
    near[triangles[doubtful]] = True
    doubtful = np.flatnonzero(touched(near, triangles))
    facing_in, still = inward(tape, found, triangles[doubtful]), set[int]()
    if not facing_in.any():
        return found
    near[triangles[doubtful]] = True
    stars = Stars(triangles[touched(near, triangles)])
    for _ in range(ROUNDS):
        turned = doubtful[facing_in]
        if len(turned) > MOST:
            break
        corners = np.unique(triangles[turned])
        moved = []
        for vertex in corners[normals[corners].any(axis=1)].tolist():
            if vertex in still:
                continue
            star = stars.around(vertex)
            still.add(vertex)
            if _moved(tape, places, normals, star, vertex):
                moved.append(vertex)
                still.difference_update(star.ravel().tolist())
        if not moved:
            break
        near[:] = False
        near[moved] = True
        stale = touched(near, triangles[doubtful])
        facing_in[stale] = inward(tape, found, triangles[doubtful[stale]])
    return found


class Stars:
    """Look-up of the triangles at a vertex."""

    def __init__(self, triangles: Ints) -> None:
        import numpy as np

        corners = triangles.ravel().astype(np.int64)  # int64 as the vertex searched for: else each call converts all
        self.triangles, self._order = triangles, np.argsort(corners, kind="stable")
        self._ascending = corners[self._order]

    def around(self, vertex: int) -> Ints:
        """(n, 3) the triangles at a vertex, in order."""
        import numpy as np

        first, last = np.searchsorted(self._ascending, [vertex, vertex + 1])
        found: Ints = self.triangles[self._order[first:last] // 3]
        return found


def _moved(tape: Tape, places: Floats, normals: Floats, star: Ints, vertex: int) -> bool:
    """Move a vertex of the triangles ``star`` (n, 3) as the kernel ``move`` does; returns whether it moved."""
    import numpy as np

    from sceneql.mesh.repair.move_kernels import move

    program = tape.code, tape.constants, tape.parts, scratch(tape)
    star = star.astype(np.int64)
    return bool(move(*program, places, normals, star, vertex, np.array(SHARES), np.empty((4, 3))))
