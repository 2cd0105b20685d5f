"""Blocks: mapped bricks cut into tetrahedra."""

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
"""[bytes] of one in its mesh; its elements take more (solid.ELEMENT)."""
Corners = Annotated[tuple[tuple[float, float, float], ...], Quantity(dim.LENGTH, (None, 3))]
UPRIGHT = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
"""The eight corners in their order, by x, y and z."""
ROUNDING = 1e-9
"""Part of a block's places by which a probe may lie outside."""
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
        """Size and corners, not eight, too many cells."""
        if (self.size is None) == (self.corners is None):
            yield Problem("a block has either a `size` or eight `corners`")
        if self.corners is not None and len(self.corners) != 8:
            yield Problem(f"a block has eight corners, not {len(self.corners)}", ("corners",))
        try:
            bounded(float(prod(self.cells)) * CUT[self.cut], "tetrahedra", TETRAHEDRON)
        except Exceeds as error:
            yield Problem(str(error), ("cells",), code="limit-refused")

    def box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Low and high corner (3,) [m] of the box around it."""
        if self.corners is not None:
            rows = [*zip(*self.corners, strict=True)]
            return tuple(map(min, rows)), tuple(map(max, rows))
        sides = [*zip(self.center, self.size or (0.0, 0.0, 0.0), strict=True)]
        return tuple(x - 0.5 * side for x, side in sides), tuple(x + 0.5 * side for x, side in sides)

    def may_hold(self, place: tuple[float, float, float]) -> bool:
        """Whether a place [m] lies inside; of corners, in the box around them."""
        low, high = self.box()
        room = ROUNDING * max(map(abs, (*low, *high)))
        return all(a - room <= x <= b + room for x, a, b in zip(place, low, high, strict=True))

    @property
    def finest(self) -> float:
        """The least side of a cell [m] of a block of even cells; else 0."""
        return min(s / n for s, n in zip(self.size, self.cells, strict=True)) if self.size is not None else 0.0

    def made(self) -> tuple[Floats, Ints]:
        """(n, 3) points and (t, 4) tetrahedra, upright where the corners are."""
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
"""Four corners of a cell and what is left between them."""


def _path(order: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The corners on the way from one corner of a cell to the opposite one along its sides (Kuhn 1960)."""
    place, found = [0, 0, 0], []
    for axis in order:
        place[axis] = 1
        found.append(tuple(place))
    return found


def _turned(four: Any) -> list[tuple[int, ...]]:
    """Corners of a tetrahedron, two of them swapped where it would be inside out."""
    (a, b, c), (d, e, f), (g, h, i) = ([p - q for p, q in zip(corner, four[0], strict=True)] for corner in four[1:])
    upright = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) > 0
    return list(four) if upright else [four[0], four[2], four[1], four[3]]


def _numbered(cells: Any, fours: Any, count: Any) -> Ints:
    """(t, 4) tetrahedra of every cell, by the numbers of a grid's points, z fastest."""
    import numpy as np

    strides = np.array([count[1] * count[2], count[2], 1])
    offsets = np.array(fours) @ strides
    found: Ints = ((cells @ strides)[:, None, None] + offsets[None]).reshape(-1, 4).astype(np.int32)
    return found
