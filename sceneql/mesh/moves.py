"""Triangles that face inward and that no flip puts right: a corner is moved. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.solid import field_gradients, field_values
from sceneql.mesh.flips import faced_outward, facing
from sceneql.mesh.polygons import Polygons

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


def settled(tape: Tape, places: Floats) -> tuple[Floats, Floats]:
    """Places brought to the surface by Newton's method along the gradient, and the unit gradients there."""
    import numpy as np

    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            slopes = field_gradients(tape, places)
            moves = (field_values(tape, places) / (slopes**2).sum(axis=1))[:, None] * slopes
            places = places - np.where(np.isfinite(moves).all(axis=1)[:, None], moves, 0.0)
        slopes = field_gradients(tape, places)
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
    for _ in range(ROUNDS):
        turned = doubtful[facing(tape, places, triangles[doubtful]) < 0.0]
        if len(turned) > MOST:
            break
        corners = np.unique(triangles[turned])
        moved = False
        for vertex in corners[normals[corners].any(axis=1)].tolist():
            moved |= _moved(tape, places, normals, triangles[(triangles == vertex).any(axis=1)], vertex)
        if not moved:
            break
    return Polygons(places, triangles, normals)


def _moved(tape: Tape, places: Floats, normals: Floats, star: Ints, vertex: int) -> bool:
    """Move a vertex of the triangles ``star`` (n, 3) around it where they gain by it; whether it was."""
    import numpy as np

    before = facing(tape, places, star).min()
    if before > 0.0:
        return False
    middle = places[np.setdiff1d(star, [vertex])].mean(axis=0)
    choices, slopes = settled(tape, places[vertex] + np.array(SHARES)[:, None] * (middle - places[vertex]))
    old = places[vertex].copy()
    gains = []
    for choice in choices:
        places[vertex] = choice
        gains.append(facing(tape, places, star).min() - before)
    best = int(np.argmax(gains))
    places[vertex] = choices[best] if gains[best] > 0.0 else old
    if gains[best] > 0.0:
        normals[vertex] = slopes[best]
    return bool(gains[best] > 0.0)
