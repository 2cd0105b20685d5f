"""Polygons as domains: distances, which side is nearest, and whether they cross."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

GROUP = 12
"""Sides in one box of the search for the nearest."""
TILE = 4096
"""Points of one task of a thread."""

Corners = tuple[tuple[float, float], ...]
Place = tuple[str, int]


def crossing(rings: Mapping[str, Corners]) -> tuple[Place, Place] | None:
    """Two sides (ring and number of the first corner) that meet where they should not; None where there are none."""
    sides = [
        (name, k, ring[k], ring[(k + 1) % len(ring)], len(ring))
        for name, ring in rings.items()
        for k in range(len(ring))
    ]
    # Sides in order of their left ends: only those that overlap along x are compared.
    sides.sort(key=lambda side: min(side[2][0], side[3][0]))
    for number, (name, k, a, b, count) in enumerate(sides):
        right = max(a[0], b[0])
        for other, m, c, d, _ in sides[number + 1 :]:
            if min(c[0], d[0]) > right:
                break
            beside = name == other and (abs(k - m) == 1 or abs(k - m) == count - 1)
            if (beside and _turn_back(a, b, c, d)) or (not beside and _meet(a, b, c, d)):
                return (name, k), (other, m)
    return None


def _cross(o: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def _meet(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], d: tuple[float, float]) -> bool:
    """Whether two segments have a point in common."""
    if max(min(a[0], b[0]), min(c[0], d[0])) > min(max(a[0], b[0]), max(c[0], d[0])):
        return False
    if max(min(a[1], b[1]), min(c[1], d[1])) > min(max(a[1], b[1]), max(c[1], d[1])):
        return False
    return _cross(a, b, c) * _cross(a, b, d) <= 0.0 and _cross(c, d, a) * _cross(c, d, b) <= 0.0


def _turn_back(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], d: tuple[float, float]) -> bool:
    """Whether two sides with a corner in common lie on one another."""
    if a in (c, d):
        a, b = b, a
    far = d if b == c else c
    along = (a[0] - b[0]) * (far[0] - b[0]) + (a[1] - b[1]) * (far[1] - b[1])
    return _cross(b, a, far) == 0.0 and along > 0.0


class Polygon:
    """The inside of polygons by the even-odd rule, as a level set (grids.cut.Level); phi is the distance."""

    flat = True

    def __init__(self, rings: Mapping[str, Floats], pieces: Mapping[str, tuple[int, int]]) -> None:
        """``pieces`` of the ring `shore`: from a corner to another."""
        import numpy as np

        self.starts = np.concatenate(list(rings.values()))
        self.ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings.values()])
        self.names = (*rings, *pieces)
        self._sides = np.concatenate([self.starts, self.ends], axis=1)
        sizes = [len(ring) for ring in rings.values()]
        begins = np.concatenate([[0], np.cumsum(sizes)])
        self._firsts = np.concatenate(
            [*(np.arange(begin, begin + size, GROUP) for begin, size in zip(begins, sizes, strict=False)), begins[-1:]]
        ).astype(np.int64)
        low, high = np.minimum(self.starts, self.ends), np.maximum(self.starts, self.ends)
        heads = self._firsts[:-1]
        self._boxes = np.concatenate([np.minimum.reduceat(low, heads), np.maximum.reduceat(high, heads)], axis=1)
        self._piece = np.repeat(np.arange(len(rings)), sizes)
        count = len(rings["shore"])
        for number, (first, last) in enumerate(pieces.values(), len(rings)):
            self._piece[(first + np.arange((last - first) % count)) % count] = number

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of the box around it."""
        import numpy as np

        return np.append(self.starts.min(axis=0), 0.0), np.append(self.starts.max(axis=0), 0.0)

    def values(self, points: Floats) -> Floats:
        """Signed distance at points (k, 3), negative inside: (k,)."""
        return self._nearest(points)[0]

    def pieces(self, points: Floats) -> NDArray[int64]:
        """(k,) the piece of the nearest side, an index into `names`."""
        found: NDArray[int64] = self._piece[self._nearest(points)[1]]
        return found

    def _nearest(self, points: Floats) -> tuple[Floats, NDArray[int64]]:
        """Signed distance (k,) and number of the nearest side."""
        import numpy as np

        from sceneql.compiled.kernels import over_tiles
        from sceneql.grids.domain.polygon_kernels import distances

        points = np.ascontiguousarray(points)
        found, sides = np.empty(len(points)), np.zeros(len(points), dtype=np.int64)

        def work(tile: int) -> None:
            last = min(len(points), (tile + 1) * TILE)
            distances(points, self._sides, self._boxes, self._firsts, found, sides, tile * TILE, last)

        over_tiles(-(-len(points) // TILE), work)
        return found, sides
