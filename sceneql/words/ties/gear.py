"""gear: two toothed wheels that mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.bodies.rigid.joint import FORCES, Joint, Side, across, axis_of, must_turn
from sceneql.kinds import Direction, Gives, Problem, field
from sceneql.system import TieRow

if TYPE_CHECKING:
    from sceneql.system import Assembly


class Gear(Joint):
    """Two wheels turn by as many teeth, in opposite senses about one axis, as if they met outside.

    Each turns about the axis of its hinge. On the world a `hinge` keeps the axis' direction. On a housing that moves or
    tumbles itself (`between: [clock.wheel, clock.case]` in its hinge) the axes go with it, and the wheels turn against
    it: it need not be named here, and a free one keeps its momentum, angular momentum and energy. The axle of a
    planet's wheel may go round on an arm (`between: [train.planet, train.arm]`). Wheels of parallel axes turn against
    the line from axle to axle, where an axle is the hinge nearest to the wheel's center of mass, or that center; their
    force is that of the teeth where they meet, across this line. Of other axes (bevel wheels) it is a torque alone, and
    on a housing or an arm each counts against the axis of the other; a hinge or a weld must hold each to its own.
    """

    gives: ClassVar[Mapping[str, Gives]] = FORCES

    teeth: tuple[int, int] = field("Teeth of the first and of the second.", at_least=1)
    axis: Direction = field("Axis of the first at the start.", "0 0 1")
    other_axis: Direction | None = field("Axis of the second at the start; by default that of the first.", None)
    inner: bool = field("The smaller runs inside the larger: both turn in one sense.", False)

    def problems(self) -> Iterator[Problem]:
        """Those of a tie; a wheel that meshes with the world."""
        yield from super().problems()
        for k, ref in enumerate(self.between):
            if not ref.name:
                yield Problem("a wheel meshes with another, not with the world", ("between", k))

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The angles of both, each times its teeth."""
        must_turn(self.between, (first, second))
        axes = [axis_of(self.axis if axis is None else axis, assembly) for axis in (None, self.other_axis)]
        vectors = []
        for axis, side in zip(axes, (first, second), strict=True):
            start, _ = across(axis)
            vectors += [(axis[0], axis[1], axis[2]), (start[0], start[1], start[2]), side.direction(start)]
        one, other = self.teeth
        no_line = 3 * [
            (0.0, 0.0, 0.0)
        ]  # told, and whether it is carried, once all hinges are known (bodies/gears/wheels.py)
        return [TieRow("gear", (*vectors, *no_line), (one, -other if self.inner else other, 0.0))]
