"""Holes of triangle meshes: boundary edges, closed boundary loops, and triangles that cap them. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints


FLAT = 1e-9
"""Twice the area over the squared longest side of a cap's triangle, below which it is left out: the hole is a slit."""


def welded(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """The mesh with coincident vertices merged and sorted by x, y and z, and without triangles of zero area."""
    order = np.lexsort(vertices.T[::-1])
    there = vertices[order]
    new = np.concatenate([[True], (there[1:] != there[:-1]).any(axis=1)]) if len(there) else np.zeros(0, dtype=bool)
    same = np.empty(len(order), dtype=np.int32)
    same[order] = np.cumsum(new) - 1
    places, triangles = there[new], same[triangles]
    a, b, c = places[triangles].transpose(1, 0, 2)
    return places, triangles[np.cross(b - a, c - a).any(axis=1)]


def open_sides(triangles: Ints) -> NDArray[int64]:
    """(k, 2) directed sides (first vertex, second vertex) of triangles (m, 3) that no opposite side cancels.

    A side with p uses in one direction and q in the other appears |p - q| times. At each vertex as many of these sides
    begin as end.
    """
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    low, high = sides.min(axis=1), sides.max(axis=1)
    keys, which = np.unique(low * (int(high.max(initial=0)) + 1) + high, return_inverse=True)
    surplus = np.bincount(which, np.where(sides[:, 0] == low, 1.0, -1.0), len(keys)).astype(np.int64)
    size = int(high.max(initial=0)) + 1
    ends = np.stack(np.divmod(keys, size), axis=1)[surplus != 0]
    left = surplus[surplus != 0]
    return np.repeat(np.where((left > 0)[:, None], ends, ends[:, ::-1]), np.abs(left), axis=0)


def loops(sides: NDArray[int64]) -> list[list[int]]:
    """Vertices of closed loops into which directed sides (k, 2) are decomposed; no loop visits a vertex twice."""
    after: dict[int, list[int]] = {}
    for first, second in sides.tolist():
        after.setdefault(first, []).append(second)
    found = []
    for start in list(after):
        while after[start]:
            path, place = [start], {start: 0}
            while path:
                here = after[path[-1]].pop()
                if here not in place:
                    place[here] = len(path)
                    path.append(here)
                    continue
                loop = path[place[here] :]
                found.append(loop)
                for vertex in loop[1:]:
                    del place[vertex]
                del path[place[here] + 1 :]
                if here == start:
                    break
    return found


def caps(vertices: Floats, sides: NDArray[int64]) -> tuple[Floats, Ints]:
    """(vertices with the holes' centers appended, cap triangles from each center to its hole's sides).

    ``sides`` (k, 2): the open sides. A slit, as where a vertex lies on an edge, gets no triangles.
    """
    middles, lids = [vertices], []
    for k, loop in enumerate(loops(sides)):
        middles.append(vertices[loop].mean(axis=0)[None])
        ahead = loop[1:] + loop[:1]
        lids.append(np.stack([ahead, loop, np.full(len(loop), len(vertices) + k)], axis=1))
    places, triangles = np.concatenate(middles), np.concatenate(lids).astype(np.int32)
    a, b, c = places[triangles].transpose(1, 0, 2)
    doubled, longest = np.linalg.norm(np.cross(b - a, c - a), axis=1), np.linalg.norm(b - a, axis=1)
    longest = np.maximum(longest, np.maximum(np.linalg.norm(c - a, axis=1), np.linalg.norm(c - b, axis=1)))
    return places, triangles[doubled > FLAT * longest**2]


def described(vertices: Floats, triangles: Ints) -> str:
    """Text on a mesh's number of holes and of their edges, as ``3 holes of 117 edges``; empty for a closed mesh."""
    _, triangles = welded(vertices, triangles)
    sides = open_sides(triangles)
    if not len(sides):
        return ""
    count = len(loops(sides))
    return f"{count} hole{'s' if count > 1 else ''} of {len(sides)} edges"
