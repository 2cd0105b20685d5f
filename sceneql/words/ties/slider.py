"""slider: a joint with one axis of translation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.bodies.rigid.drive import Driven, Follows, Motor
from sceneql.bodies.rigid.joint import FORCES, Side, across, axis_of, must_turn, parallel
from sceneql.kinds import (
    Damping,
    Direction,
    FixedLength,
    FixedTime,
    Gives,
    Length,
    Problem,
    Quantity,
    Record,
    Scalar,
    Speed,
    Stiffness,
    Value,
    field,
    quantity_type,
)
from sceneql.quantities import dimension as dim
from sceneql.system import TieRow

if TYPE_CHECKING:
    from sceneql.system import Assembly


class SliderMotor(Record):
    """A motor: at most a force at which it follows a speed or a shift; or that force alone."""

    said_by: ClassVar[Mapping[str, str]] = {"torque": "the motor of a slider has a `force`: `motor: {force: 3 N}`"}

    force: Annotated[Value, Quantity(dim.FORCE)] = field(
        "The largest force with `speed` or `shift`; without them the force on the first body, against the second."
    )
    speed: Speed | None = field("The speed that it follows.", None)
    shift: Length | None = field("The shift that it follows, from the place at the start.", None)
    settling: FixedTime = field("Time in which an error of the shift falls to a part 1/e.", "0.1 s", above=0)

    def problems(self) -> Iterator[Problem]:
        """Two things to follow; a largest force below 0."""
        if self.speed is not None and self.shift is not None:
            yield Problem("a motor follows a speed or a shift, not both", ("shift",), at_key=True)
        if self.speed is None and self.shift is None:
            return
        if self.force.constant and self.force.number() < 0:
            yield Problem("the largest force is not below 0", ("force",))


class Slider(Driven):
    """The first body moves along an axis of the second, and keeps its rotation against it.

    The shift is 0 at the start. Along the axis there may be a spring and a damping, - stiffness (shift - rest) -
    damping speed, a motor, stops at `limits`, and dry friction, which act as those of a hinge.
    """

    said_by: ClassVar[Mapping[str, str]] = {"drive": "that is a motor: `motor: {force: 3 N}`"}
    gives: ClassVar[Mapping[str, Gives]] = {
        "shift": Gives(quantity_type(dim.LENGTH), "How far it has moved along the axis."),
        "speed": Gives(quantity_type(dim.VELOCITY), "How fast it moves."),
        "effort": Gives(quantity_type(dim.FORCE), "Force of motor, stops and friction on the first body."),
        "given": Gives(quantity_type(dim.ENERGY), "Energy that its motor gave, by whole steps.", tally=True),
        **FORCES,
    }

    axis: Direction = field("Its axis at the start; its length does not matter.", "1 0 0")
    motor: SliderMotor | None = field("What moves the first body along the axis.", None)
    limits: Annotated[tuple[float, float], Quantity(dim.LENGTH, (2,))] | None = field(
        "Least and greatest shift, from the place at the start, where stops are.", None
    )
    restitution: Scalar = field("Speed after a stop as a part of that before.", "0", at_least=0, at_most=1)
    friction: Annotated[Value, Quantity(dim.FORCE)] | None = field(
        "Force of dry friction, up to which it holds and with which it rubs.", None, at_least=0
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

    def driver(self) -> Motor | None:
        """What the motor does."""
        if self.motor is None:
            return None
        speed, shift = self.motor.speed, self.motor.shift
        follows: Follows = "nothing" if speed is shift else "speed" if shift is None else "place"
        return Motor(self.motor.force, follows, shift if speed is None else speed, self.motor.settling)
