"""Polygons as domains: distances, which side is nearest, and whether they cross."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

AT_ONCE = 2_000_000
"""Pairs of a point and a side that are looked at together."""

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

    def __init__(self, rings: Mapping[str, Floats], pieces: Mapping[str, tuple[int, int]]) -> None:
        """``pieces`` of the ring `shore`: from a corner to another."""
        import numpy as np

        self.starts = np.concatenate(list(rings.values()))
        self.ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings.values()])
        self.names = (*rings, *pieces)
        self._piece = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings.values()])
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
        import numpy as np

        found = np.empty(len(points))
        for some in self._chunks(len(points)):
            square, _ = self._nearest(points[some])
            x, y = points[some, 0, None], points[some, 1, None]
            (ax, ay), (bx, by) = self.starts.T, self.ends.T
            over = (ay > y) != (by > y)
            rise = np.where(by == ay, 1.0, by - ay)
            inside = (over & (x < ax + (y - ay) * (bx - ax) / rise)).sum(axis=1) % 2 == 1
            found[some] = np.sqrt(square) * np.where(inside, -1.0, 1.0)
        return found

    def pieces(self, points: Floats) -> NDArray[int64]:
        """(k,) the piece of the nearest side, an index into `names`."""
        import numpy as np

        found = np.empty(len(points), dtype=np.int64)
        for some in self._chunks(len(points)):
            found[some] = self._piece[self._nearest(points[some])[1]]
        return found

    def _chunks(self, count: int) -> list[slice]:
        size = max(1, AT_ONCE // len(self.starts))
        return [slice(k, min(count, k + size)) for k in range(0, count, size)]

    def _nearest(self, points: Floats) -> tuple[Floats, NDArray[int64]]:
        """Square of the distance (k,) and number of the nearest side."""
        import numpy as np

        along = self.ends - self.starts
        reach = points[:, None, :2] - self.starts
        t = np.clip((reach * along).sum(axis=2) / (along * along).sum(axis=1), 0.0, 1.0)
        square = ((reach - t[:, :, None] * along) ** 2).sum(axis=2)
        nearest = square.argmin(axis=1)
        return square[np.arange(len(points)), nearest], nearest
