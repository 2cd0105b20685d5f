"""Blocks: structured grids in a hexahedron, each cell cut into tetrahedra."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations
from math import prod
from typing import TYPE_CHECKING, Annotated, Any, Literal

from sceneql import kinds
from sceneql.island.memory import bounded
from sceneql.kinds import Exceeds, Problem, Quantity, Record, field
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

TETRAHEDRON = 500
"""Memory [bytes] of a tetrahedron in a mesh; an element on it takes more (elements.filled.BYTES)."""
Corners = Annotated[tuple[tuple[float, float, float], ...], Quantity(dim.LENGTH, (None, 3))]
UPRIGHT = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
"""The eight corners of a block in the order of its field `corners`, by x, y and z."""
ROUNDING = 1e-9
"""Distance by which a probe may lie outside a block, relative to the block's largest coordinate."""
CUT = {"six": 6, "five": 5}


class Block(Record):
    """A brick of cells, each cut into tetrahedra."""

    size: Annotated[tuple[float, float, float], Quantity(dim.LENGTH, (3,))] | None = field(
        "Its sides along x, y and z.", None, above=0
    )
    center: kinds.FixedPosition = field("Where its middle is, of one with a `size`.", "0 0 0 m")
    corners: Corners | None = field(
        "In place of a size its eight corners: four around the bottom, counterclockwise from above, then those above.",
        None,
    )
    cells: tuple[int, int, int] = field("Cells along its three sides.", (4, 4, 4), at_least=1)
    cut: Literal["six", "five"] = field(
        "Tetrahedra of a cell: six alike in all cells, or five, mirrored in turns.", "six"
    )

    def problems(self) -> Iterator[Problem]:
        """Problems: both or neither of size and corners; not eight corners; too many cells."""
        if (self.size is None) == (self.corners is None):
            yield Problem("a block has either a `size` or eight `corners`")
        if self.corners is not None and len(self.corners) != 8:
            yield Problem(f"a block has eight corners, not {len(self.corners)}", ("corners",))
        try:
            bounded(float(prod(self.cells)) * CUT[self.cut], "tetrahedra", TETRAHEDRON)
        except Exceeds as error:
            yield Problem(str(error), ("cells",), code="limit-refused")

    def box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Low and high corner (3,) [m] of the block's bounding box."""
        if self.corners is not None:
            rows = [*zip(*self.corners, strict=True)]
            return tuple(map(min, rows)), tuple(map(max, rows))
        sides = [*zip(self.center, self.size or (0.0, 0.0, 0.0), strict=True)]
        return tuple(x - 0.5 * side for x, side in sides), tuple(x + 0.5 * side for x, side in sides)

    def may_hold(self, place: tuple[float, float, float]) -> bool:
        """Whether a place (3,) [m] lies in the block's bounding box."""
        low, high = self.box()
        room = ROUNDING * max(map(abs, (*low, *high)))
        return all(a - room <= x <= b + room for x, a, b in zip(place, low, high, strict=True))

    @property
    def finest(self) -> float:
        """Shortest side [m] of the cells of a block with a `size`; 0 for one with `corners`."""
        return min(s / n for s, n in zip(self.size, self.cells, strict=True)) if self.size is not None else 0.0

    def mean_side(self) -> float:
        """Mean side [m] of its cells: the cube root of the bounding box's volume over their number."""
        low, high = self.box()
        return float((prod(b - a for a, b in zip(low, high, strict=True)) / prod(self.cells)) ** (1 / 3))

    def made(self) -> tuple[Floats, Ints]:
        """Points (n, 3) [m] and tetrahedra (t, 4), of positive volume where the corners are in their order."""
        import numpy as np

        count = np.array(self.cells) + 1
        grid = np.stack(np.meshgrid(*(np.arange(c) for c in count), indexing="ij"), axis=-1).reshape(-1, 3)
        share = grid / np.array(self.cells)
        upright = np.array(UPRIGHT, dtype=float)
        if self.size is not None:
            points = np.array(self.center) + (share - 0.5) * np.array(self.size)
        else:
            each = np.where(upright[None] == 1, share[:, None], 1.0 - share[:, None]).prod(axis=2)
            points = each @ np.array(self.corners)
        cells = np.stack(np.meshgrid(*(np.arange(c) for c in self.cells), indexing="ij"), axis=-1).reshape(-1, 3)
        six = [[(0, 0, 0), *_path(order)] for order in permutations(range(3))]
        if self.cut == "six":
            return points, _numbered(cells, [_turned(four) for four in six], count)
        odd = cells.sum(axis=1) % 2 == 1
        mirrored = [_turned([(1 - x, y, z) for x, y, z in four]) for four in FIVE]
        even = [_turned(four) for four in FIVE]
        return points, np.concatenate([_numbered(cells[~odd], even, count), _numbered(cells[odd], mirrored, count)])


FIVE = (
    ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((1, 1, 0), (0, 1, 0), (1, 0, 0), (1, 1, 1)),
    ((1, 0, 1), (0, 0, 1), (1, 1, 1), (1, 0, 0)),
    ((0, 1, 1), (1, 1, 1), (0, 0, 1), (0, 1, 0)),
    ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)),
)
"""Tetrahedra of a cell cut in five: four at corners, and the one between them."""


def _path(order: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The three corners after (0, 0, 0) on the path along a cell's sides in an order of axes (Kuhn 1960)."""
    place, found = [0, 0, 0], []
    for axis in order:
        place[axis] = 1
        found.append(tuple(place))
    return found


def _turned(four: Any) -> list[tuple[int, ...]]:
    """Corners of a tetrahedron, with two of them swapped if its volume would be negative."""
    (a, b, c), (d, e, f), (g, h, i) = ([p - q for p, q in zip(corner, four[0], strict=True)] for corner in four[1:])
    upright = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) > 0
    return list(four) if upright else [four[0], four[2], four[1], four[3]]


def _numbered(cells: Any, fours: Any, count: Any) -> Ints:
    """Tetrahedra (t, 4) of all cells (c, 3), as numbers of the grid's points, z fastest; ``count`` (3,): its points."""
    import numpy as np

    strides = np.array([count[1] * count[2], count[2], 1])
    offsets = np.array(fours) @ strides
    found: Ints = ((cells @ strides)[:, None, None] + offsets[None]).reshape(-1, 4).astype(np.int32)
    return found
