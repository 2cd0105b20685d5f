"""impulse: a blow, which changes velocities instantaneously."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from sceneql.bodies.place import HELP, model_of, place_of
from sceneql.kinds import FixedTime, Interaction, Position, Problem, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Link

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sceneql.system import Assembly, Bodies


class Impulse(Interaction):
    """A blow at an instant: m dv = J, and the angular momentum of a rigid body changes by r x J (Newton 1687).

    It acts at the end of the solver's step that reaches its time; steps that a tolerance chooses end there. The energy
    that it brings is counted, with negative sign, among the dissipated, as if no tie held what it strikes.
    """

    on: Position = field("What it strikes: a mass, `net.bob`, or a point of a rigid body, `crate.hook`.")
    at: FixedTime = field("When.", above=0)
    value: Annotated[Value, Quantity(dim.MOMENTUM, (3,))] = field("Force times time.")

    def targets(self) -> tuple[str, ...]:
        """The model of what it strikes."""
        return model_of(self.on)

    def problems(self) -> Iterator[Problem]:
        """A place that is no mass's."""
        if not isinstance(self.on.expr, Link):
            yield Problem(f"this is a place, but no mass to strike: {HELP}", ("on",))

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the blow, and let steps end at its time."""
        from sceneql.bodies.time_shift import APART
        from sceneql.island.breakpoint_table import after

        place = place_of(self.on, assembly)
        if place.bodies.immersed is not None:
            text = f"'{place.bodies.model}' moves as its flow does, which a blow at an instant would not move"
            help = 'take a `force` by formula that lasts a little: `{components: "[step(0.1, t), 0, 0]", at: ...}`'
            raise ScriptError([Diagnostic("invalid", text, self.on.span, help)])
        ints = (*place.ints, assembly.value(self.value), assembly.floats([self.at]))
        assembly.after_step("sceneql.words.forces.impulse_kernels:strike", ints)
        assembly.stop_at(self.at - APART)  # a short last step: frames within it interpolate velocities
        assembly.stop_at(after(self.at))
