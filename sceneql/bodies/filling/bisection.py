"""Refinement of tetrahedral meshes by longest edge bisection, which keeps them conforming. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.tetrahedra import edges

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

ALIKE = 1e-9
"""Relative difference below which edges count as equally long, so that their numbers decide which is longest."""


def bisected(
    points: Floats, tetrahedra: Ints, wanted: Callable[[Floats], Floats], bounded: Callable[[float], None]
) -> tuple[Floats, Ints, NDArray[int64]]:
    """Refined points (n, 3) [m], tetrahedra (t, 4), and for each (t,) the original tetrahedron that it is a part of.

    No longest edge exceeds ``wanted`` (k,) [m] at its tetrahedron's center (k, 3). An edge is bisected when it is the
    longest of all tetrahedra around it; longer edges of these are bisected before (Rivara 1984, 1991). ``bounded``
    raises where the tetrahedra are too many.
    """
    parents = np.arange(len(tetrahedra))
    while True:
        ends, which = edges(tetrahedra)
        longest = _longest(points, ends, which)
        of = ends[longest]
        length = np.linalg.norm(points[of[:, 0]] - points[of[:, 1]], axis=1)
        asked = wanted(points[tetrahedra].mean(axis=1))
        coarse = length > (1.0 + ALIKE) * asked
        if not coarse.any():
            return points, tetrahedra, parents
        bounded(len(tetrahedra) + float(((length[coarse] / asked[coarse]) ** 3).sum()))
        marked = np.zeros(len(ends), dtype=bool)
        marked[longest[coarse]] = True
        count = 0
        while count < (count := int(np.count_nonzero(marked))):
            marked[longest[marked[which].any(axis=1)]] = True
        around = np.bincount(which.ravel(), minlength=len(ends))
        marked &= np.bincount(longest, minlength=len(ends)) == around
        some = np.flatnonzero(marked[longest])
        number = np.cumsum(marked) - 1 + len(points)
        points = np.concatenate([points, points[ends[marked]].mean(axis=1)])
        halves = [tetrahedra]
        for side in (0, 1):
            gone = ends[longest[some], side][:, None]
            new = number[longest[some]][:, None]
            halves.append(np.where(tetrahedra[some] == gone, new, tetrahedra[some]).astype(np.int32))
        tetrahedra = np.delete(np.concatenate(halves), some, axis=0)
        parents = np.delete(np.concatenate([parents, parents[some], parents[some]]), some)


def _longest(points: Floats, ends: NDArray[int64], which: NDArray[int64]) -> Any:
    """Number (t,) of the longest edge of each tetrahedron; ``ends`` (e, 2), ``which`` (t, 6): its edges."""
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    rank = np.empty(len(ends), dtype=np.int64)
    rank[np.lexsort((np.arange(len(ends)), np.round(np.log(length) / ALIKE)))] = np.arange(len(ends))
    return which[np.arange(len(which)), np.argmax(rank[which], axis=1)]
