"""Self-intersections of polygons. Imports no numpy, since the command `check` uses it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

Point = tuple[float, float]
Corners = tuple[Point, ...]
Place = tuple[str, int]
MANY = 8
"""Comparisons per side, on average, beyond which a tree of boxes is faster than a sweep along x."""
LEAF = 8
"""Most sides in a leaf of the tree of boxes."""


@dataclass(frozen=True, slots=True)
class Side:
    """A side of a closed polygon (ring)."""

    ring: str
    number: int
    """Number of its first corner in the ring."""
    first: Point
    last: Point
    count: int
    """Number of sides of the ring."""

    @property
    def place(self) -> Place:
        """(name of the ring, number of the first corner)."""
        return self.ring, self.number

    def wrongly_meets(self, other: Side) -> bool:
        """Whether the two sides intersect, other than in the common corner of consecutive sides."""
        apart = abs(self.number - other.number)
        ends = self.first, self.last, other.first, other.last
        if self.ring == other.ring and (apart in (1, self.count - 1)):
            return _turn_back(*ends)
        return _meet(*ends)


@dataclass(frozen=True, slots=True)
class Box:
    """A node of a tree of bounding boxes around sides."""

    low: Point
    high: Point
    least: int
    """The smallest index of its sides in the sorted order."""
    held: Sequence[tuple[int, float, float, float, float]]
    """For the sides of a leaf: index in the sorted order, low and high corner. Empty for other nodes."""
    halves: tuple[Box, ...] = ()

    def touches(self, other: Box) -> bool:
        """Whether two boxes have a point in common."""
        return (
            self.low[0] <= other.high[0]
            and other.low[0] <= self.high[0]
            and self.low[1] <= other.high[1]
            and other.low[1] <= self.high[1]
        )


def crossing(rings: Mapping[str, Corners]) -> tuple[Place, Place] | None:
    """The first two sides (ring, number of the first corner) that intersect wrongly; None where there are none.

    First in the order of the sides' left ends.
    """
    sides = [
        Side(name, k, ring[k], ring[(k + 1) % len(ring)], len(ring))
        for name, ring in rings.items()
        for k in range(len(ring))
    ]
    sides.sort(key=lambda side: min(side.first[0], side.last[0]))
    lefts = [min(side.first[0], side.last[0]) for side in sides]
    left = MANY * len(sides)
    for number, side in enumerate(sides):
        right = max(side.first[0], side.last[0])
        for k in range(number + 1, len(sides)):
            if lefts[k] > right:
                break
            left -= 1
            if side.wrongly_meets(sides[k]):
                return side.place, sides[k].place
        if left < 0:
            found = _first_crossing(sides)
            return None if found is None else (sides[found[0]].place, sides[found[1]].place)
    return None


def _first_crossing(sides: Sequence[Side]) -> tuple[int, int] | None:
    """Indices of the first two of the sorted sides that intersect wrongly, by a tree of boxes."""
    lows = [(min(side.first[0], side.last[0]), min(side.first[1], side.last[1])) for side in sides]
    highs = [(max(side.first[0], side.last[0]), max(side.first[1], side.last[1])) for side in sides]

    def boxed(held: list[int]) -> Box:
        low = min(lows[k][0] for k in held), min(lows[k][1] for k in held)
        high = max(highs[k][0] for k in held), max(highs[k][1] for k in held)
        if len(held) <= LEAF:
            return Box(low, high, min(held), [(k, *lows[k], *highs[k]) for k in held])
        middles = [[lows[k][axis] + highs[k][axis] for k in held] for axis in (0, 1)]
        axis = 0 if max(middles[0]) - min(middles[0]) > max(middles[1]) - min(middles[1]) else 1
        order = sorted(held, key=lambda k: lows[k][axis] + highs[k][axis])
        half = len(order) // 2
        return Box(low, high, min(held), (), (boxed(order[:half]), boxed(order[half:])))

    best: tuple[int, int] | None = None
    whole = boxed(list(range(len(sides))))
    waiting = [(whole, whole)]
    while waiting:
        one, other = waiting.pop()
        if not one.touches(other) or (best is not None and min(one.least, other.least) > best[0]):
            continue
        if one.halves or other.halves:
            waiting += _parts(one, other)
            continue
        for k, left, low, right, high in one.held:
            for m, its_left, its_low, its_right, its_high in other.held:
                if its_left > right or left > its_right or its_low > high or low > its_high:
                    continue
                pair = (k, m) if k < m else (m, k)
                if (k < m or one is not other) and k != m and (best is None or pair < best):
                    best = pair if sides[pair[0]].wrongly_meets(sides[pair[1]]) else best
    return best


def _parts(one: Box, other: Box) -> Iterator[tuple[Box, Box]]:
    """All pairs of children of two boxes, at least one of which is no leaf; each pair once."""
    ones, others = one.halves or (one,), other.halves or (other,)
    for k, part in enumerate(ones):
        for m, counterpart in enumerate(others):
            if one is not other or k <= m:
                yield part, counterpart


def _cross(o: Point, a: Point, b: Point) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether two segments have a point in common."""
    if max(min(a[0], b[0]), min(c[0], d[0])) > min(max(a[0], b[0]), max(c[0], d[0])):
        return False
    if max(min(a[1], b[1]), min(c[1], d[1])) > min(max(a[1], b[1]), max(c[1], d[1])):
        return False
    return _cross(a, b, c) * _cross(a, b, d) <= 0.0 and _cross(c, d, a) * _cross(c, d, b) <= 0.0


def _turn_back(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether two sides with a common corner overlap: the second runs back along the first."""
    if a in (c, d):
        a, b = b, a
    far = d if b == c else c
    along = (a[0] - b[0]) * (far[0] - b[0]) + (a[1] - b[1]) * (far[1] - b[1])
    return _cross(b, a, far) == 0.0 and along > 0.0
