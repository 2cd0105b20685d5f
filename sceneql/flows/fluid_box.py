"""The box of cells of a flow: given by its sides, or around the object whose inside the fluid fills."""

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
"""Distance [cells] from a named side of the box from which on the level set is continued constantly, since the domain
may end at this side. It exceeds the distance within which walls matter (obstacles.ROUND)."""


LARGEST_FACTOR = 11
"""Largest prime factor of a number of cells: a transform of n numbers takes about n p operations for a factor p."""


class Around:
    """The complement of an object as a level set, negative outside the object.

    Near named sides of the box the level set is continued constantly along the normal of the side.
    """

    def __init__(self, level: Any, low: Floats, high: Floats) -> None:
        """``low``, ``high`` (3,) [m]: start of the constant continuation; infinite along axes without named sides."""
        self.level, self.low, self.high = level, low, high

    def values(self, points: Floats) -> Floats:
        """Values (k,) at points (k, 3) [m]."""
        found: Floats = -self.level.values(np.clip(points, self.low, self.high))
        return found


def around(ref: Ref, faces: Faces, named: Container[str], assembly: Assembly) -> Around:
    """The complement of a flow's domain; ``faces``: of the flow's box, ``named``: sides that the script names."""
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
    """(level set of an object, low and high corner of its box, whether it is two-dimensional).

    Raises ScriptError for an object without an inside.
    """
    try:
        return inside(ref, flat, cast("Moment", Start(assembly)))
    except (TypeError, ValueError) as error:
        message = f"'{ref.name}' cannot be the domain of a flow: {error}"
        raise ScriptError([Diagnostic("no-domain", message, ref.span)]) from error


def _quick(count: int) -> int:
    """The smallest number >= count without prime factors above LARGEST_FACTOR, for fast transforms."""
    while max(factors(count), default=1) > LARGEST_FACTOR:
        count += 1
    return count


def box_of(
    domain: Ref | None, flat: bool, size: tuple[float, ...], corner: tuple[float, ...], cell: float, depth: float,
    named: Container[str], assembly: Assembly,
) -> cells.Cells:  # fmt: skip
    """The cells of a flow's box, given by its sides or made around a domain.

    On sides that the script does not name, the box extends one cell beyond the domain, whose surface is the wall; its
    numbers of cells allow fast transforms. Raises ScriptError where the domain moves, has no inside or is thinner than
    two cells, LimitRefused for too many cells.
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
