"""The box of a flow: by its sides, or around the object whose inside it fills."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.contacts.colliders import is_moving
from sceneql.failure import LimitRefused
from sceneql.flows.transforms import factors
from sceneql.grids.domain import cells
from sceneql.grids.domain.cells import SIDES
from sceneql.grids.domain.domain import inside
from sceneql.island.start import Start
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Container

    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.kinds import Moment, Ref
    from sceneql.system import Assembly

INSET = 3.0
"""How far off an open side of the box, in cells, the level there is taken, as the domain may end at that side: further
than distances from walls are looked at (obstacles.ROUND)."""


LARGEST_FACTOR = 11
"""Of numbers of cells: transforms of n numbers by a factor p take about n p."""


class Around:
    """The level of what is around an object, below 0 beside it; drawn on beyond sides of the box that are open."""

    def __init__(self, level: Any, low: Floats, high: Floats) -> None:
        """``low``, ``high``: (3,) from where on it is drawn on; endless along axes without such sides."""
        self.level, self.low, self.high = level, low, high

    def values(self, points: Floats) -> Floats:
        """(k,) at points (k, 3)."""
        found: Floats = -self.level.values(np.clip(points, self.low, self.high))
        return found


def around(ref: Ref, faces: Faces, named: Container[str], assembly: Assembly) -> Around:
    """What is around the domain of a flow, whose box has these faces; ``named``: sides that the script names."""
    low, high = np.full(3, -np.inf), np.full(3, np.inf)
    spacing = faces.cells.spacing
    for number, name in enumerate(SIDES[: 2 * faces.axes]):
        axis, at_end = divmod(number, 2)
        if name in named and at_end:
            high[axis] = faces.low[axis] + (faces.cells.shape[axis] - INSET) * spacing[axis]
        elif name in named:
            low[axis] = faces.low[axis] + INSET * spacing[axis]
    return Around(level_of(ref, faces.axes == 2, assembly)[0], low, high)


def level_of(ref: Ref, flat: bool, assembly: Assembly) -> tuple[Any, Floats, Floats, bool]:
    """The level of an object, the box around it, whether it is flat. Raises ScriptError for one without an inside."""
    try:
        return inside(ref, flat, cast("Moment", Start(assembly)))
    except (TypeError, ValueError) as error:
        message = f"'{ref.name}' cannot be the domain of a flow: {error}"
        raise ScriptError([Diagnostic("no-domain", message, ref.span)]) from error


def _quick(count: int) -> int:
    """The next number from a count on without large prime factors, by which transforms take as long as they are."""
    while max(factors(count), default=1) > LARGEST_FACTOR:
        count += 1
    return count


def box_of(
    domain: Ref | None, flat: bool, size: tuple[float, ...], corner: tuple[float, ...], cell: float, depth: float,
    named: Container[str], assembly: Assembly,
) -> cells.Cells:  # fmt: skip
    """The cells of a flow's box: where the script names no side, a cell more than its domain, whose skin is the wall,
    and so many that transforms are fast.

    Raises ScriptError where the domain moves or has no inside; LimitRefused.
    """
    if domain is None:
        return cells.box(size, corner, cell, depth)
    if is_moving(cast(Object, assembly.object(domain))):
        text, help = f"'{domain.name}' is the domain of a flow, and moves", "let solids `around` which it flows move"
        raise ScriptError([Diagnostic("moves", text, domain.span, help)])
    _, low, high, thin = level_of(domain, flat, assembly)
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    axes = 2 if thin else 3
    sides = (high - low)[:axes]
    count = float(np.prod(np.ceil(sides / cell)))
    if not count <= cells.MOST_CELLS:
        text = f"{count:.3g} cells: at most {cells.MOST_CELLS:,} are possible"
        raise LimitRefused(text, assembly.line(), "take a larger `cell`")
    if not (sides > 2.0 * cell).all():
        text = f"'{domain.name}' holds no two cells of {cell:g} m along each side"
        raise ScriptError([Diagnostic("no-cell", text, domain.span, "take a smaller `cell`")])
    for axis in range(axes):
        ends = [end for side, end in zip(SIDES[2 * axis : 2 * axis + 2], (low, high), strict=True) if side not in named]
        for end in ends:
            end[axis] += cell if end is high else -cell
        count = int(np.ceil((high - low)[axis] / cell * (1.0 - 1e-9)))
        more = _quick(count) - count
        for end in ends:
            end[axis] += (cell if end is high else -cell) * more / len(ends)
    return cells.box(tuple((high - low)[:axes].tolist()), tuple(low[:axes].tolist()), cell, depth)
