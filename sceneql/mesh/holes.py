"""Holes of triangle meshes: their edges, how many they are, and triangles that close them. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints


FLAT = 1e-9
"""Height over length of a triangle in a slit, whose sides lie on one another: it is left out."""


def welded(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """The mesh with coincident vertices merged, ordered by x, y and z, and triangles without area left out."""
    order = np.lexsort(vertices.T[::-1])
    there = vertices[order]
    new = np.concatenate([[True], (there[1:] != there[:-1]).any(axis=1)]) if len(there) else np.zeros(0, dtype=bool)
    same = np.empty(len(order), dtype=np.int32)
    same[order] = np.cumsum(new) - 1
    places, triangles = there[new], same[triangles]
    a, b, c = places[triangles].transpose(1, 0, 2)
    return places, triangles[np.cross(b - a, c - a).any(axis=1)]


def open_sides(triangles: Ints) -> NDArray[int64]:
    """(k, 2) sides of triangles (m, 3), first and second vertex, that no other triangle has the other way round.

    Of sides that several have as often as they differ in number: what is left has as many begin at a vertex as end.
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
    """The vertices of closed paths along sides (k, 2), each side in one of them, that meet no vertex twice."""
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
    """Vertices with the middles of the holes behind them, and triangles from each middle to its hole's sides (k, 2).

    A slit, as where a vertex lies within an edge, gets none.
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
    """How many holes a mesh has and how many edges they have, as ``3 holes of 117 edges``; empty of a closed one."""
    _, triangles = welded(vertices, triangles)
    sides = open_sides(triangles)
    if not len(sides):
        return ""
    count = len(loops(sides))
    return f"{count} hole{'s' if count > 1 else ''} of {len(sides)} edges"
