"""Triangles that face inward, put right by flips of edges. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.solid import many_gradients

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Rows = NDArray[np.int64]

ROUNDS = 8
SLIVER = 1.0e-6
"""Height of a triangle over its longest side, below which it has no direction."""


def faced_outward(tape: Tape, places: Floats, triangles: Ints, doubtful: Rows) -> Ints:
    """The triangles (t, 3) with edges flipped where one of the rows ``doubtful`` (n,) faces away from the gradient.

    An edge of two triangles becomes the other diagonal of their four corners where both then face the gradient better
    and that is no edge already: what is closed and 2-manifold stays so.
    """
    import numpy as np

    found = triangles.astype(np.int64)
    for _ in range(ROUNDS):
        turned = doubtful[facing(tape, places[found[doubtful]]) < 0.0]
        near = np.zeros(len(places), dtype=bool)
        near[found[turned]] = True
        around = np.flatnonzero(near[found].any(axis=1))
        changed = _flipped(tape, places, found[around], np.searchsorted(around, turned))
        if not changed:
            break
        for at, row in changed.items():
            found[around[at]] = row
        doubtful = np.union1d(turned, around[list(changed)])
    return found.astype(np.int32)


def facing(tape: Tape, corners: Floats) -> Floats:
    """(t,) cosine of the angle between the normals of triangles (t, 3, 3) and the gradients in their middles.

    0 where there is no gradient, and of a SLIVER, as along a sharp edge, whose normal is noise.
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


def _flipped(tape: Tape, places: Floats, triangles: Rows, turned: Rows) -> dict[int, tuple[int, int, int]]:
    """New corners of some triangles (t, 3), by their rows: the flips of edges of those ``turned`` that gain the most.

    All triangles at the corners of those must be there.
    """
    import numpy as np

    rows = triangles.tolist()
    owner = {(row[k], row[(k + 1) % 3]): at for at, row in enumerate(rows) for k in range(3)}
    choices = []
    for at in turned.tolist():
        for k in range(3):
            a, b, c = rows[at][k], rows[at][(k + 1) % 3], rows[at][(k + 2) % 3]
            other = owner.get((b, a))
            if other is not None:
                (d,) = set(rows[other]) - {a, b}
                if c != d and (c, d) not in owner and (d, c) not in owner:
                    choices.append((at, other, (c, a, d), (d, b, c)))
    if not choices:
        return {}
    old = triangles[np.array([choice[:2] for choice in choices]).ravel()]
    new = np.array([choice[2:] for choice in choices]).reshape(-1, 3)
    least = [facing(tape, places[corners]).reshape(-1, 2).min(axis=1) for corners in (old, new)]
    gains = least[1] - least[0]
    changed: dict[int, tuple[int, int, int]] = {}
    edges: set[frozenset[int]] = set()
    for k in np.argsort(-gains, kind="stable").tolist():
        at, other, first, second = choices[k]
        edge = frozenset((first[0], first[2]))
        if gains[k] > 0.0 and at not in changed and other not in changed and edge not in edges:
            changed |= {at: first, other: second}
            edges.add(edge)
    return changed
