"""Finer tetrahedra where these are wanted, by halving longest edges: meshes stay conforming. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.tetrahedra import edges, volumes

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

ALIKE = 1e-9
"""Relative difference of the lengths of edges that counts as none: their numbers decide then."""
FLAT = 0.1
"""A half that is below this part of a straight half has the straight middle of its edge."""


def bisected(
    points: Floats,
    tetrahedra: Ints,
    wanted: Callable[[Floats], Floats],
    middles: Callable[[Floats, Ints], Floats],
    bounded: Callable[[float], None],
) -> tuple[Floats, Ints]:
    """Points (n, 3) [m] and tetrahedra (t, 4) none of whose edges is longer than wanted in its middle.

    ``wanted``: lengths [m] at places (k, 3); ``middles``: the places of new points in the middles of all edges, in the
    order of `edges`; ``bounded`` raises where there are too many tetrahedra. An edge is halved when it is the longest
    of all tetrahedra around it, these others first (Rivara 1984, 1991).
    """
    while True:
        ends, which = edges(tetrahedra)
        longest, own = _longest(points, ends, which)
        of = ends[longest]
        length = np.linalg.norm(points[of[:, 0]] - points[of[:, 1]], axis=1)
        asked = wanted(points[tetrahedra].mean(axis=1))
        coarse = length > (1.0 + ALIKE) * asked
        if not coarse.any():
            return points, tetrahedra
        bounded(len(tetrahedra) + float(((length[coarse] / asked[coarse]) ** 3).sum()))
        marked = np.zeros(len(ends), dtype=bool)
        marked[longest[coarse]] = True
        count = 0
        while count < (count := int(np.count_nonzero(marked))):
            marked[longest[marked[which].any(axis=1)]] = True
        around = np.bincount(which.ravel(), minlength=len(ends))
        marked &= np.bincount(longest, minlength=len(ends)) == around
        points, tetrahedra = _halved(points, tetrahedra, ends, longest, own, marked, middles)


def _longest(points: Floats, ends: NDArray[int64], which: NDArray[int64]) -> tuple[NDArray[int64], Any]:
    """(t,) the longest edge of each tetrahedron, and its place among the tetrahedron's own."""
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    alike = np.round(np.log(length) / ALIKE)
    rank = np.empty(len(ends), dtype=np.int64)
    rank[np.lexsort((np.arange(len(ends)), alike))] = np.arange(len(ends))
    own = np.argmax(rank[which], axis=1)
    return which[np.arange(len(which)), own], own


def _halved(
    points: Floats, tetrahedra: Ints, ends: Any, longest: Any, own: Any, marked: Any, middles: Any
) -> tuple[Floats, Ints]:
    """With the marked edges halved, each the longest of all tetrahedra around it."""
    some = np.flatnonzero(marked[longest])
    edge = longest[some]
    number = np.cumsum(marked) - 1 + len(points)
    straight = 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])
    found = np.where(marked[:, None], middles(points, tetrahedra), straight)
    halves = []
    for side in (0, 1):
        half = tetrahedra[some].astype(np.int64)
        halves.append(np.where(half == ends[edge, side][:, None], number[edge][:, None], half))
    least = FLAT * 0.5 * volumes(points, tetrahedra[some])
    while True:
        placed = np.concatenate([points, found[marked]])
        turned = edge[np.any([volumes(placed, half) < least for half in halves], axis=0)]
        turned = turned[(found[turned] != straight[turned]).any(axis=1)]
        if not len(turned):
            break
        found[turned] = straight[turned]
    kept = np.delete(tetrahedra, some, axis=0)
    return placed, np.concatenate([kept, *halves]).astype(np.int32)
