"""Skeletons as rows of a tape: parts of points, segments, triangles and curves, in a hierarchy of boxes.

Imports numpy: to be imported by the function that needs it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.frame import held

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

    NDBool = NDArray[bool_]
    Order = NDArray[int64]

KERNELS = ("wyvill", "soft_object", "metaball", "gaussian", "inverse_square")
"""In the order of the constants of falloff_kernels."""
SEGMENT, TRIANGLE, NODE, CURVE = range(4)
"""As in skeleton_parts_kernels."""
FLAT = 1e-6
"""Sine of the angle between two sides below which a triangle is replaced by its longest side."""
BRANCHES = 8
"""Children of a box: parts, or boxes of parts."""
SPREAD = (16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)
"""Shifts and masks by which ten bits of a number come to lie three apart."""
WIDER = 1e-9
"""Padding of boxes, relative to their size and to their distance from the origin."""


@dataclass(frozen=True, slots=True, eq=False)
class Skeleton:
    """Parts of a density field: see skeleton_kernels for the formula."""

    corners: Floats
    """(p, 3, 3) [m]: ends a and b, and c of a triangle or curve; a segment has c = a, a point a = b = c."""
    radii: Floats
    """(p, 2) [m] > 0, at a and at b; a triangle has the first alone."""
    weights: Floats
    """(p,), the same within a group."""
    groups: Floats
    """(p,) whole numbers >= 0: within a group only the largest density counts."""
    kernel: int = 0
    """Index into KERNELS."""
    middles: Floats | None = None
    """(p,) [m] > 0, the radius at the control point c of a quadratic Bezier curve a c b; NaN for other parts."""
    _made: dict[str, NDArray[Any]] = field(default_factory=dict, init=False, repr=False)
    """What was made of it before: its arrays never change."""

    def kept(self, name: str, make: Callable[[], NDArray[Any]]) -> NDArray[Any]:
        """An array made of the parts, which do not change: once for each name, and read-only."""
        if name not in self._made:
            self._made[name] = held(make())
        return self._made[name]

    @property
    def curved(self) -> NDBool:
        """(p,) which parts are curves."""
        return np.zeros(len(self.weights), dtype=bool) if self.middles is None else np.isfinite(self.middles)

    @property
    def largest(self) -> Floats:
        """(p,) [m] an upper bound of each part's radius."""
        ends: Floats = np.maximum(self.radii[:, 0], self.radii[:, 1])
        return ends if self.middles is None else np.fmax(ends, self.middles)

    def weighted(self, weights: Floats) -> Skeleton:
        """The same parts with other weights (p,)."""
        return replace(self, weights=weights)

    def plain(self) -> NDBool:
        """(p,) which parts are points or segments of one radius, alone in their group, with Wyvill's kernel."""
        return self.kept("plain", self._plain).copy()

    def _plain(self) -> NDBool:
        a, b, c = self.corners.transpose(1, 0, 2)
        lone: NDBool = np.ones(len(self.groups), dtype=bool)
        if not (self.groups[1:] > self.groups[:-1]).all():
            _, where, count = np.unique(self.groups, return_inverse=True, return_counts=True)
            lone = count[where] == 1
        flat = (c == a).all(axis=1) | (c == b).all(axis=1)
        plain: NDBool = lone & flat & ~self.curved & (self.radii[:, 0] == self.radii[:, 1]) & (self.kernel == 0)
        return plain

    def chosen(self, which: NDBool) -> Skeleton:
        """The parts chosen by a mask (p,)."""
        if which.all():
            return self
        middles = None if self.middles is None else self.middles[which]
        return Skeleton(
            self.corners[which], self.radii[which], self.weights[which], self.groups[which], self.kernel, middles
        )

    def density_rows(self) -> Floats:
        """(p, 8) rows of the operation DENSITY, for plain parts only."""
        return np.concatenate(
            [self.corners[:, :2].reshape(-1, 6), self.radii[:, :1], self.weights[:, None]], axis=1
        )  # fmt: skip

    def rows(self) -> Floats:
        """(r, 8) rows of the operation SKELETON: parts in spatial order, groups together, boxes before their parts."""
        return self.kept("rows", self._rows)

    def _rows(self) -> Floats:
        corners, radii, shapes, condition = _settled(self.corners, self.radii)
        curved = self.curved
        corners[curved], radii[curved], shapes[curved] = self.corners[curved], self.radii[curved], CURVE
        if self.middles is not None:
            condition[curved] = self.middles[curved]
        low = np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])  # a third of a reduction's time
        high = np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2])
        reach = self.largest[:, None]
        order = _order(0.5 * (low + high), self.groups)
        low, high = (low - reach)[order], (high + reach)[order]
        room = WIDER * (high - low + np.abs(low) + np.abs(high))
        low, high = low - room, high + room
        n = len(order)
        sizes = _sizes(n)
        places = 2 * (np.arange(n) + sum((np.arange(n) // size + 1 for size in sizes), start=np.zeros(n, dtype=int)))
        total = n + sum(-(-n // size) for size in sizes)
        rows = np.zeros((2 * total, 8))
        rows[places, :6] = corners[order, :2].reshape(-1, 6)
        rows[places, 6], rows[places, 7] = radii[order, 0], self.weights[order]
        rows[places + 1, :3], rows[places + 1, 3] = corners[order, 2], radii[order, 1]
        rows[places + 1, 4], rows[places + 1, 5] = self.kernel, self.groups[order]
        rows[places + 1, 6], rows[places + 1, 7] = shapes[order], condition[order]
        # The boxes of a level are those of its children together, the smallest first
        for size in sizes[::-1]:
            starts = np.arange(0, n, size)
            within = np.arange(0, len(low), BRANCHES)
            low, high = np.minimum.reduceat(low, within), np.maximum.reduceat(high, within)
            nodes = 2 * (starts + sum(starts // other + (other > size) for other in sizes))
            ends = np.minimum(starts + size, n)
            behind = 2 * (ends + sum(-(-ends // other) for other in sizes))
            rows[nodes, :3], rows[nodes, 3:6] = low, high
            rows[nodes, 6], rows[nodes + 1, 6] = behind - nodes - 2, NODE
        return rows


def plain_points(rows: Floats) -> Floats | None:
    """The parts among ``rows`` (r, 8) of a SKELETON, as rows of a DENSITY; None unless all are plain.

    Segments are among them: their two ends differ.
    """
    first: Floats
    first, second = rows[::2], rows[1::2]
    part = second[:, 6] != NODE
    first, second = first[part], second[part]
    alone = len(second) == 0 or int(np.bincount(second[:, 5].astype(np.int64)).max()) == 1
    if not alone or (second[:, 4] != 0).any() or (second[:, 6] != SEGMENT).any() or (first[:, 6] != second[:, 3]).any():
        return None
    return first


def _sizes(n: int) -> list[int]:
    """Number of parts in a box on each level of the hierarchy, the largest first."""
    sizes = []
    size = BRANCHES
    while n > size:
        sizes.append(size)
        size *= BRANCHES
    return sizes[::-1]


def _settled(corners: Floats, radii: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """(corners, radii, shapes, condition) of the parts, with degenerate triangles replaced by their longest sides."""
    if (corners[:, 1:] == corners[:, :1]).all():  # points
        return corners.copy(), radii.copy(), np.full(len(corners), SEGMENT), np.ones(len(corners))
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    product = np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
    triangle = normal > FLAT * product
    condition = np.where(triangle, np.divide(product, normal, out=np.ones(len(a)), where=normal > 0), 1.0)
    sides = np.stack([np.linalg.norm(corners[:, (k + 1) % 3] - corners[:, k], axis=1) for k in range(3)])
    longest = np.argmax(sides, axis=0)
    pick = np.arange(len(a))
    ends = np.stack([corners[pick, longest], corners[pick, (longest + 1) % 3]], axis=1)
    degenerate = ~triangle & (longest > 0)
    settled, reach = corners.copy(), radii.copy()
    settled[degenerate, :2] = ends[degenerate]
    settled[~triangle, 2] = settled[~triangle, 0]
    reach[degenerate | triangle, 1] = reach[degenerate | triangle, 0]
    return settled, reach, np.where(triangle, TRIANGLE, SEGMENT), condition


def _order(places: Floats, groups: Floats) -> Order:
    """Order of the parts: groups by their middles along Morton's curve (1966), and parts likewise within each group."""
    n = len(places)
    if n <= BRANCHES:
        return np.lexsort([np.arange(n), groups])
    if (groups[1:] > groups[:-1]).all():  # each alone in its group
        return np.argsort(_morton(places), kind="stable")
    _, where, count = np.unique(groups, return_inverse=True, return_counts=True)
    middles = np.stack([np.bincount(where, places[:, k]) for k in range(3)], axis=1) / count[:, None]
    return np.lexsort([_morton(places), groups, _morton(middles)[where]])


def _morton(places: Floats) -> Order:
    """Index along Morton's curve of points (n, 3)."""
    low = places.min(axis=0)
    size = float((places.max(axis=0) - low).max()) or 1.0
    cells = np.minimum((places - low) / size * 1024.0, 1023.0).astype(np.int64)
    for shift, mask in SPREAD:
        cells = (cells | cells << shift) & mask
    code: Order = cells[:, 0] | cells[:, 1] << 1 | cells[:, 2] << 2
    return code
