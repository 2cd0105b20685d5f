"""Where coarse and fine cells share a face: the surface's curves on it, from either side. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Ints
    from sceneql.mesh.cubes.levels import Level, Numbering

    Keys = NDArray[np.int64]


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

    on_group = np.zeros(len(fine.places), dtype=bool)
    on_group[: len(fine.doubled)] = (fine.doubled % (2 * parts * group) == 0).any(axis=1)
    starts, stops = border(fine.triangles, on_group)
    first, last = fine.doubled[starts], fine.doubled[stops]
    across = np.argmax((first == last) & (first % (2 * parts) == 0), axis=1)
    middle = (first + last) // 2
    high = middle // (2 * parts)
    low = high.copy()
    low[np.arange(len(low)), across] -= 1
    cells = np.where(among(numbers.of(high // group), chosen)[:, None], low, high)
    on_edge = (fine.doubled % (2 * parts) == 0).sum(axis=1) == 2
    following = np.full(len(fine.doubled), -1)
    # Through a vertex inside a coarse face one curve passes; on a coarse edge several may end.
    through = ~on_edge[starts]
    following[starts[through]] = stops[through]
    begins = on_edge[starts]
    columns = [starts[begins], stops[begins]]
    while not on_edge[columns[-1]].all():
        columns.append(np.where(on_edge[columns[-1]], columns[-1], following[columns[-1]]))
    paths = np.stack(columns, axis=1)
    edges = [_coarse(fine.doubled[paths[:, k]], parts) for k in (0, -1)]
    followed = np.zeros(len(fine.doubled), dtype=bool)
    followed[paths] = True
    rings = through & ~followed[starts]
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

    some = (at[triangles] & at[triangles[:, [1, 2, 0]]]).ravel()
    starts = triangles.ravel()[some].astype(np.int64)
    stops = triangles[:, [1, 2, 0]].ravel()[some].astype(np.int64)
    single = ~np.isin(stops * len(at) + starts, starts * len(at) + stops, assume_unique=True)
    return stops[single], starts[single]
