"""Where coarse and fine cells share a face: the surface's curves on it, from either side. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from sceneql.mesh.cubes.border_kernels import follow, mark_borders, open_sides

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Ints
    from sceneql.mesh.cubes.levels import Level, Numbering

    Keys = NDArray[np.int64]

LENGTH = 16
"""Vertices of a curve for which there is room at first."""


class Sides(NamedTuple):
    """Sides of coarse triangles that lie on faces shared with fine cells."""

    triangles: Keys
    """(s,) row of the coarse triangle."""
    turns: Keys
    """(s,) number k of the side, which runs from the triangle's vertex k to vertex k + 1."""
    cells: Keys
    """(s, 3) place of the coarse cell."""
    ends: Keys
    """(s,) key of the pair of coarse edges that the side connects."""


class Curves(NamedTuple):
    """Border curves of the fine triangles on faces shared with coarse cells, directed like the coarse sides there."""

    paths: Keys
    """(c, n) fine vertices along the curve, padded with the last one."""
    cells: Keys
    """(c, 3) place of the coarse cell."""
    ends: Keys
    """(c,) key of the pair of coarse edges that the curve connects; -1 if it ends on one edge, or is closed."""


def among(keys: Keys, ascending: Keys) -> NDArray[np.bool_]:
    """(n,) whether each key is in ``ascending``, a sorted array that is not empty."""
    import numpy as np

    at = np.minimum(np.searchsorted(ascending, keys), len(ascending) - 1)
    found: NDArray[np.bool_] = ascending[at] == keys
    return found


def pair(numbers: Numbering, first: Keys, second: Keys) -> Keys:
    """(n,) keys of pairs of edges of one cube, given by their middles (n, 3) in half cells."""
    import numpy as np

    # The difference is within -2..2 along each axis.
    found: Keys = numbers.of(first) * 125 + (second - first + 2) @ np.array([1, 5, 25])
    return found


def face_sides(coarse: Level, kept: NDArray[np.bool_], numbers: Numbering, chosen: Keys, group: int) -> Sides:
    """The sides of the ``kept`` coarse triangles on faces of the refined groups; ``chosen``: sorted keys of these."""
    import numpy as np

    # Only groups beside a refined one have sides on such faces.
    strides = np.concatenate([numbers.strides, -numbers.strides])
    beside = np.unique((chosen[:, None] + strides).ravel())
    rows = np.flatnonzero(kept)
    rows = rows[among(numbers.of(coarse.cells[rows] // group), beside)]
    parts: list[tuple[Keys, ...]] = []
    edges = len(coarse.doubled)
    for turn in range(3):
        a, b = coarse.triangles[rows, turn], coarse.triangles[rows, (turn + 1) % 3]
        on_edges = (a < edges) & (b < edges)
        at, a, b = rows[on_edges], coarse.doubled[a[on_edges]], coarse.doubled[b[on_edges]]
        common = (a == b) & (a % 2 == 0)
        on_face = common.any(axis=1)
        at, a, b, common = at[on_face], a[on_face], b[on_face], common[on_face]
        cells = coarse.cells[at]
        beyond = cells + np.where(common, np.where(a == 2 * cells, -1, 1), 0)
        finer = among(numbers.of(beyond // group), chosen)
        parts.append((at[finer], np.full(finer.sum(), turn), cells[finer], pair(numbers, a[finer], b[finer])))
    return Sides(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def border_curves(fine: Level, parts: int, numbers: Numbering, chosen: Keys, group: int) -> Curves:
    """The curves along the border of the fine triangles, of which ``parts`` cells fill a coarse cell's side."""
    import numpy as np

    on_edge, on_group = np.zeros((2, len(fine.places)), dtype=bool)
    mark_borders(fine.doubled, 2 * parts, 2 * parts * group, on_edge, on_group)
    starts, stops = border(fine.triangles, on_group)
    first, last = fine.doubled[starts], fine.doubled[stops]
    across = np.argmax((first == last) & (first % (2 * parts) == 0), axis=1)
    middle = (first + last) // 2
    high = middle // (2 * parts)
    low = high.copy()
    low[np.arange(len(low)), across] -= 1
    cells = np.where(among(numbers.of(high // group), chosen)[:, None], low, high)
    begins = on_edge[starts]
    paths, followed = _paths(starts, stops, on_edge, int(begins.sum()))
    edges = [_coarse(fine.doubled[paths[:, k]], parts) for k in (0, -1)]
    rings = ~begins & ~followed[starts]
    return Curves(
        np.concatenate([paths, np.repeat(starts[rings, None], paths.shape[1], axis=1)]),
        np.concatenate([cells[begins], cells[rings]]),
        np.concatenate([_ends(numbers, *edges), np.full(rings.sum(), -1)]),
    )


def _ends(numbers: Numbering, first: Keys, second: Keys) -> Keys:
    """Numbers from ``pair``, but -1 for two ends on the same edge."""
    import numpy as np

    return np.where((first == second).all(axis=1), -1, pair(numbers, first, second))


def _coarse(doubled: Keys, parts: int) -> Keys:
    """The coarse edges on which fine edges lie, as middles in half coarse cells."""
    import numpy as np

    along = doubled % (2 * parts) != 0
    return np.where(along, 2 * (doubled // (2 * parts)) + 1, doubled // parts)


def border(triangles: Ints, at: NDArray[np.bool_]) -> tuple[Keys, Keys]:
    """(starts, stops) vertices of the sides with a triangle on one side only, reversed as the missing one has them.

    Only sides with both ends in the mask ``at`` (v,) of vertices are looked at.
    """
    import numpy as np

    starts, stops = np.empty((2, 3 * len(triangles)), dtype=np.int64)
    begin, ends = np.zeros(len(at) + 2, dtype=np.int32), np.empty(3 * len(triangles), dtype=np.int32)
    count = open_sides(triangles, at, begin, ends, starts, stops)
    return starts[:count], stops[:count]


def _paths(starts: Keys, stops: Keys, on_edge: NDArray[np.bool_], count: int) -> tuple[Keys, NDArray[np.bool_]]:
    """(c, n) vertices of the ``count`` paths from one vertex ``on_edge`` (v,) to the next, padded with the last, and
    (v,) whether a vertex is on one.
    """
    import numpy as np

    room, longest = 0, LENGTH
    while longest > room:
        room = longest
        paths, followed = np.empty((count, room), dtype=np.int64), np.zeros(len(on_edge), dtype=bool)
        _, longest = follow(starts, stops, on_edge, np.empty(len(on_edge), dtype=np.int32), paths, followed)
    return np.ascontiguousarray(paths[:, : max(longest, 2)]), followed
