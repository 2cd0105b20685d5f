"""Polygons as domains: signed distances, and the nearest side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

GROUP = 12
"""Sides of a polygon in one bounding box of the search for the nearest side."""
CORNER = 0.2
"""Least angle [rad] between the directions of consecutive sides that counts as a corner."""
TILE = 4096
"""Points of one task of a thread."""


class Polygon:
    """The inside of polygons by the even-odd rule, as a level set (domain.cut.Level); phi is the signed distance."""

    flat = True

    def __init__(self, rings: Mapping[str, Floats], pieces: Mapping[str, tuple[int, int]]) -> None:
        """``rings``: corners (k, 2) [m] of closed polygons. ``pieces``: (first, last corner) of parts of `shore`."""
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
        """Low and high corner (3,) [m] of the bounding box; z is 0."""
        import numpy as np

        return np.append(self.starts.min(axis=0), 0.0), np.append(self.starts.max(axis=0), 0.0)

    def holds(self, points: Floats) -> NDArray[bool_]:
        """Whether each (k,) of points (k, 3) lies inside, by numpy without compiled code: for few points."""
        import numpy as np

        x, y = points[:, :1], points[:, 1:2]
        (ax, ay), (bx, by) = self.starts.T, self.ends.T
        crossed = (ay <= y) != (by <= y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = ax + (y - ay) / (by - ay) * (bx - ax)
        found: NDArray[bool_] = (crossed & (x < at)).sum(axis=1) % 2 == 1
        return found

    def corners(self) -> Floats:
        """Points (k, 2) [m] at which sides meet at an angle (CORNER), or two pieces meet."""
        import numpy as np

        before = np.empty(len(self.starts), dtype=np.int64)
        order = np.lexsort(self.starts.T), np.lexsort(self.ends.T)
        before[order[0]] = order[1]
        ways = self.ends - self.starts
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        bent = (ways * ways[before]).sum(axis=1) < np.cos(CORNER)
        found: Floats = self.starts[bent | (self._piece != self._piece[before])]
        return found

    def values(self, points: Floats) -> Floats:
        """Signed distances (k,) [m] at points (k, 3) [m], negative inside."""
        return self._nearest(points)[0]

    def pieces(self, points: Floats) -> NDArray[int64]:
        """Index (k,) into `names` of the piece nearest to each point (k, 3)."""
        found: NDArray[int64] = self._piece[self._nearest(points)[1]]
        return found

    def _nearest(self, points: Floats) -> tuple[Floats, NDArray[int64]]:
        """Signed distances (k,) [m] and numbers (k,) of the nearest sides, of points (k, 3)."""
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
