"""hinge: a body turns about an axis of the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.bodies.rigid.drive import Driven
from sceneql.bodies.rigid.joint import FORCES, Side, across, axis_of, must_turn, point_of, together
from sceneql.kinds import Direction, FixedAngle, Gives, Position, Quantity, Value, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.system import TieRow

if TYPE_CHECKING:
    from sceneql.system import Assembly

TORQUE = dim.FORCE * dim.LENGTH


class Hinge(Driven):
    """Two bodies share a point and an axis, about which one turns against the other.

    The angle is that of the first body against the second, 0 at the start, over full turns too; about the axis it may
    have a spring, a damping and a torque in time: torque - stiffness (angle - rest) - damping speed.
    """

    gives: ClassVar[Mapping[str, Gives]] = {
        "angle": Gives(quantity_type(dim.ANGLE), "How far it has turned."),
        "speed": Gives(quantity_type(dim.FREQUENCY), "How fast it turns."),
        **FORCES,
    }

    at: Position = field("Where it is at the start.")
    axis: Direction = field("Its axis at the start; its length does not matter.", "0 0 1")
    drive: Annotated[Value, Quantity(TORQUE)] | None = field(
        "Torque on the first body about the axis, against the second.", None
    )
    stiffness: Annotated[Value, Quantity(TORQUE)] | None = field("Torque for an angle [N m/rad].", None, at_least=0)
    rest: FixedAngle = field("The angle without a torque of the spring.", "0 deg")
    damping: Annotated[Value, Quantity(TORQUE * dim.TIME)] | None = field(
        "Torque for an angular speed [N m s/rad].", None, at_least=0
    )

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The point, and the axis across two directions of the second body."""
        must_turn(self.between, (first, second))
        axis = axis_of(self.axis, assembly)
        held = first.direction(axis)
        point = point_of(self.at, self.between, (first, second), assembly)
        sides = [TieRow("angle", (held, second.direction(side))) for side in across(axis)]
        return together(first, second, point) + sides

    def motion(self, first: Side, second: Side, assembly: Assembly) -> tuple[str, tuple[Any, ...]]:
        """A turn about the axis, from a direction across it."""
        axis = axis_of(self.axis, assembly)
        side, _ = across(axis)
        return "turn", (first.direction(side), second.direction(side), second.direction(axis))

    def along(self) -> tuple[Value | None, Value | None, float, Value | None]:
        """Torque, stiffness, rest and damping."""
        return self.drive, self.stiffness, self.rest, self.damping
