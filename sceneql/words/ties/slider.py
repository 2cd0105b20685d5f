"""slider: a body moves along an axis of the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.bodies.rigid.drive import Driven
from sceneql.bodies.rigid.joint import FORCES, Side, across, axis_of, must_turn, parallel
from sceneql.kinds import Damping, Direction, FixedLength, Gives, Quantity, Stiffness, Value, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.system import TieRow

if TYPE_CHECKING:
    from sceneql.system import Assembly


class Slider(Driven):
    """The first body moves along an axis of the second, and keeps its rotation against it.

    The shift is 0 at the start; along the axis there may be a spring, a damping and a force in time:
    drive - stiffness (shift - rest) - damping speed.
    """

    gives: ClassVar[Mapping[str, Gives]] = {
        "shift": Gives(quantity_type(dim.LENGTH), "How far it has moved along the axis."),
        "speed": Gives(quantity_type(dim.VELOCITY), "How fast it moves."),
        **FORCES,
    }

    axis: Direction = field("Its axis at the start; its length does not matter.", "1 0 0")
    drive: Annotated[Value, Quantity(dim.FORCE)] | None = field(
        "Force on the first body along the axis, against the second.", None
    )
    stiffness: Stiffness | None = field("Force for a shift.", None, at_least=0)
    rest: FixedLength = field("The shift without a force of the spring.", "0 m")
    damping: Damping | None = field("Force for a speed.", None, at_least=0)

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The center of the first across two directions of the second, and three directions."""
        must_turn(self.between, (first, second))
        ends = first.place(first.position), second.place(first.position)
        sides = across(axis_of(self.axis, assembly))
        return [TieRow("point", (*ends, second.direction(side))) for side in sides] + parallel(first, second)

    def motion(self, first: Side, second: Side, assembly: Assembly) -> tuple[str, tuple[Any, ...]]:
        """A shift of the first body's center along the axis."""
        axis = second.direction(axis_of(self.axis, assembly))
        return "shift", (first.place(first.position), second.place(first.position), axis)

    def along(self) -> tuple[Value | None, Value | None, float, Value | None]:
        """Force, stiffness, rest and damping."""
        return self.drive, self.stiffness, self.rest, self.damping
