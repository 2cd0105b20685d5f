"""Triangles that face inward and that no flip puts right: a corner is moved. Imports numpy and numba."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import field_values, many_gradients
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.flips import faced_outward, facing

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Rows = NDArray[np.int64]

STEPS = 4
"""Of Newton's method towards the surface."""
ROUNDS = 8
MOST = 256
"""Triangles that are put right by moves; more are of a field that is too fine for its cells."""
SHARES = (0.25, 0.5, 0.75, 1.0)
"""Of the way to the middle of its neighbors that a vertex may go."""


def settled(tape: Tape, begun: Floats, reach: Floats | float = inf) -> tuple[Floats, Floats]:
    """Places (n, 3) brought to the surface by Newton's method along the gradient, and the unit gradients there.

    Those that would go farther than ``reach`` [m], one or (n,), stay: where f jumps, the method goes anywhere.
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
    """The polygons with triangles that face inward put right, of the rows ``doubtful`` (n,): by flips, then by moves.

    A vertex goes along the surface towards the middle of its neighbors where the worst of its triangles then faces the
    gradient better; those without a normal, on edges of the solid, stay.
    """
    import numpy as np

    places, normals = polygons.vertices.copy(), polygons.normals.copy()
    triangles = faced_outward(tape, places, polygons.triangles, doubtful)
    near = np.zeros(len(places), dtype=bool)
    near[triangles[doubtful]] = True
    doubtful = np.flatnonzero(near[triangles].any(axis=1))
    near[triangles[doubtful]] = True
    stars = Stars(triangles[near[triangles].any(axis=1)])
    cosines, still = facing(tape, places[triangles[doubtful]]), set[int]()
    for _ in range(ROUNDS):
        turned = doubtful[cosines < 0.0]
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
        stale = near[triangles[doubtful]].any(axis=1)
        cosines[stale] = facing(tape, places[triangles[doubtful[stale]]])
    return Polygons(places, triangles, normals)


class Stars:
    """Triangles by their corners."""

    def __init__(self, triangles: Ints) -> None:
        import numpy as np

        corners = triangles.ravel().astype(np.int64)  # as vertices are asked for: else all are converted at each call
        self.triangles, self._order = triangles, np.argsort(corners, kind="stable")
        self._ascending = corners[self._order]

    def around(self, vertex: int) -> Ints:
        """(n, 3) the triangles at a vertex, in their order."""
        import numpy as np

        first, last = np.searchsorted(self._ascending, [vertex, vertex + 1])
        found: Ints = self.triangles[self._order[first:last] // 3]
        return found


def _moved(tape: Tape, places: Floats, normals: Floats, star: Ints, vertex: int) -> bool:
    """Move a vertex of the triangles ``star`` (n, 3) around it where they gain by it; whether it was.

    Newton's method may take it no farther than its triangles reach.
    """
    import numpy as np

    at = places[star]
    before = facing(tape, at).min()
    if before > 0.0:
        return False
    middle = places[np.setdiff1d(star, [vertex])].mean(axis=0)
    reach = np.linalg.norm(at - places[vertex], axis=-1).max()
    choices, slopes = settled(tape, places[vertex] + np.array(SHARES)[:, None] * (middle - places[vertex]), reach)
    after = np.where((star == vertex)[:, :, None], choices[:, None, None], at)
    gains = facing(tape, after.reshape(-1, 3, 3)).reshape(len(choices), -1).min(axis=1) - before
    best = int(np.argmax(gains))
    if gains[best] > 0.0:
        places[vertex], normals[vertex] = choices[best], slopes[best]
    return bool(gains[best] > 0.0)
