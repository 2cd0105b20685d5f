"""hinge: a joint with one axis of rotation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.bodies.rigid.drive import Driven, Follows, Motor
from sceneql.bodies.rigid.joint import FORCES, Side, across, axis_of, must_turn, point_of, together
from sceneql.kinds import (
    Angle,
    Direction,
    FixedAngle,
    FixedTime,
    Gives,
    Position,
    Problem,
    Quantity,
    Record,
    Ref,
    Scalar,
    Value,
    field,
    quantity_type,
)
from sceneql.quantities import dimension as dim
from sceneql.system import TieRow

if TYPE_CHECKING:
    from sceneql.system import Assembly

TORQUE = dim.FORCE * dim.LENGTH


class HingeMotor(Record):
    """A motor: at most a torque at which it follows a speed or an angle; or that torque alone."""

    said_by: ClassVar[Mapping[str, str]] = {"force": "the motor of a hinge has a `torque`: `motor: {torque: 3 N*m}`"}

    torque: Annotated[Value, Quantity(TORQUE)] = field(
        "The largest torque with `speed` or `angle`; without them the torque on the first body, against the second."
    )
    speed: Annotated[Value, Quantity(dim.FREQUENCY, turning=True)] | None = field("The speed that it follows.", None)
    angle: Angle | None = field("The angle that it follows, from that at the start.", None)
    settling: FixedTime = field("Time in which an error of the angle falls to a part 1/e.", "0.1 s", above=0)

    def problems(self) -> Iterator[Problem]:
        """Two things to follow; a largest torque below 0."""
        if self.speed is not None and self.angle is not None:
            yield Problem("a motor follows a speed or an angle, not both", ("angle",), at_key=True)
        if self.speed is None and self.angle is None:
            return
        if self.torque.constant and self.torque.number() < 0:
            yield Problem("the largest torque is not below 0", ("torque",))


class Hinge(Driven):
    """Two bodies share a point and an axis, about which one turns against the other.

    The angle is that of the first body against the second, 0 at the start, over full turns too. About the axis it may
    have a spring and a damping, - stiffness (angle - rest) - damping speed, a motor, stops at `limits`, and dry
    friction. Stops, friction, and motors that follow something, act on the velocities at the end of a step, with all
    contacts at once (mode `local`): a step in which one acts is of order 1, others are the solver's own. Where rigid
    bodies of the same island collide in mode `exact`, stops are impacts with their own restitution, located as all
    others, and motors and friction have the solver's order. A motor that follows an angle goes by the angle's own speed
    and (angle - what it is)/settling; a stop at which the body is as slow as its forces make it in two steps holds it.

    Pictures show a pin where it holds an object to the world, unless something at rest stands there.
    """

    said_by: ClassVar[Mapping[str, str]] = {"drive": "that is a motor: `motor: {torque: 3 N*m}`"}
    gives: ClassVar[Mapping[str, Gives]] = {
        "angle": Gives(quantity_type(dim.ANGLE), "How far it has turned."),
        "speed": Gives(quantity_type(dim.FREQUENCY), "How fast it turns."),
        "effort": Gives(quantity_type(TORQUE), "Torque of motor, stops and friction on the first body."),
        "given": Gives(quantity_type(dim.ENERGY), "Energy that its motor gave, by whole steps.", tally=True),
        **FORCES,
    }

    at: Position = field("Where it is at the start.")
    axis: Direction = field("Its axis at the start; its length does not matter.", "0 0 1")
    motor: HingeMotor | None = field("What turns the first body against the second.", None)
    limits: Annotated[tuple[float, float], Quantity(dim.ANGLE, (2,), needs_unit=True)] | None = field(
        "Least and greatest angle, from that at the start, where stops are.", None
    )
    restitution: Scalar = field("Speed after a stop as a part of that before.", "0", at_least=0, at_most=1)
    friction: Annotated[Value, Quantity(TORQUE)] | None = field(
        "Torque of dry friction, up to which it holds and with which it rubs.", None, at_least=0
    )
    stiffness: Annotated[Value, Quantity(TORQUE)] | None = field("Torque for an angle [N m/rad].", None, at_least=0)
    rest: FixedAngle = field("The angle without a torque of the spring.", "0 deg")
    damping: Annotated[Value, Quantity(TORQUE * dim.TIME)] | None = field(
        "Torque for an angular speed [N m s/rad].", None, at_least=0
    )

    def support(self) -> tuple[Value, Value] | None:
        """A pin along its axis, where one of the bodies is the world."""
        return None if all(ref.name for ref in self.between) else (self.at, self.axis)

    def places(self) -> Iterator[tuple[Value, tuple[Ref, ...]]]:
        """Its point, on both."""
        yield self.at, self.between

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

    def driver(self) -> Motor | None:
        """What the motor does."""
        if self.motor is None:
            return None
        speed, angle = self.motor.speed, self.motor.angle
        follows: Follows = "nothing" if speed is angle else "speed" if angle is None else "place"
        return Motor(self.motor.torque, follows, angle if speed is None else speed, self.motor.settling)
