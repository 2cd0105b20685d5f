"""Splits sides that four dual polygons share, so that the mesh is a 2-manifold. Imports numpy.

Two cubes share a face with two curves on it. If in each cube both curves belong to one dual vertex, the side between
the two dual vertices is shared by four polygons. A new vertex on each of the face's curves splits it into two sides.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

Side = tuple[int, int]


def split_nonmanifold(
    quads: Ints, rings: Ints, crossings: Floats, fresh: int
) -> tuple[NDArray[np.int64], Floats, Ints]:
    """(rows of quads without a shared side, new vertices (n, 3) [m], triangles that replace the other quads).

    ``quads`` (e, 4): dual vertices around each crossed grid edge; ``rings`` (v, 12): crossed edges around each dual
    vertex, -1 after the last; ``crossings`` (e, 3) [m]: where the surface crosses the edges. New vertices are numbered
    from ``fresh`` on.
    """
    import numpy as np

    ends = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2), axis=2).astype(np.int64)
    keys = ends[:, :, 0] * fresh + ends[:, :, 1]
    _, place, uses = np.unique(keys, return_inverse=True, return_counts=True)
    shared = uses[place].reshape(keys.shape) > 2
    broken = np.flatnonzero(shared.any(axis=1))
    sound = np.setdiff1d(np.arange(len(quads)), broken)
    added: list[Floats] = []
    on_face: dict[tuple[int, Side], int] = {}
    triangles: list[tuple[int, int, int]] = []

    def face_vertex(edge: int, side: Side) -> int:
        """The new vertex on the curve from an edge across the face between the two cubes of a side."""
        if (edge, side) not in on_face:
            other = _beside(rings[side[0]], edge, set(sharing[side]))
            on_face[edge, side] = on_face[other, side] = fresh + len(added)
            added.append(0.5 * (crossings[edge] + crossings[other]))
        return on_face[edge, side]

    sharing: dict[Side, list[int]] = {}
    for crossing in map(int, broken):
        for first, second in ends[crossing][shared[crossing]].tolist():
            sharing.setdefault((first, second), []).append(crossing)
    for crossing in map(int, broken):
        around: list[int] = []
        for k, corner in enumerate(quads[crossing]):
            around.append(int(corner))
            if shared[crossing, k]:
                first, second = map(int, ends[crossing, k])
                around.append(face_vertex(crossing, (first, second)))
        center = fresh + len(added)
        added.append(crossings[crossing])
        triangles += [(a, b, center) for a, b in pairwise([*around, around[0]])]
    return sound, np.array(added, dtype=np.float64).reshape(-1, 3), np.array(triangles, dtype=np.int32).reshape(-1, 3)


def _beside(ring: Ints, edge: int, among: set[int]) -> int:
    """One of an edge's two neighbors in a ring: the one in the set ``among``."""
    members = [int(other) for other in ring if other >= 0]
    at = members.index(edge)
    before, after = members[at - 1], members[(at + 1) % len(members)]
    return before if before in among else after
