"""gravity: the same acceleration everywhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import model_validator

from sceneql.kinds import Acceleration, Direction, Force, Quantity, Value, field
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState


class Gravity(Force):
    """Uniform gravity: F = m g, with the potential energy -m g . x (zero at the origin).

    By default 9.81 m/s^2 downwards, along -y exactly. Of masses that a flow carries m is less what they displace.
    Source: Newton, Principia (1687), book I, law II.

    For example `moon: {gravity: {strength: 1.62 m/s^2}}`.
    """

    weighs: ClassVar[bool] = True

    strength: Annotated[Value, Quantity(dim.ACCELERATION)] = field("How strong it is.", "9.81 m/s^2", at_least=0)
    direction: Direction = field("Where it points; its length does not matter.", "0 -1 0")
    acceleration: Acceleration | None = field("The vector g, in place of strength and direction.", None)

    @model_validator(mode="before")
    @classmethod
    def _is_said_once(cls, given: Any) -> Any:
        if isinstance(given, dict) and given.get("acceleration") is not None and {"strength", "direction"} & set(given):
            raise ValueError("give either the vector `acceleration`, or `strength` and `direction`")
        return given

    def at_a_distance(self) -> bool:
        """Smooth wherever no two masses meet."""
        return True

    def uniform(self) -> bool:
        """The same everywhere."""
        return True

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add F = m g to every mass."""
        from sceneql.system import Slopes

        vector = self.direction if self.acceleration is None else self.acceleration
        given = int(self.acceleration is not None)
        ints = (bodies.velocity_at, bodies.count, bodies.weighed_at, given)
        parameters = (assembly.value(vector), assembly.value(self.strength))
        assembly.term(
            "force",
            "sceneql.words.forces.gravity_kernels:gravity",
            (*ints, *parameters, bodies.position_at, bodies.inverse_at),
            Slopes("", (), ()),
            apart=True,
            energy="sceneql.words.forces.gravity_energy_kernels:energy",
        )
        assembly.remember(given, *parameters)

    def assemble_weight(self, name: str, assembly: Assembly) -> None:
        """Add g to what fluids of several densities weigh."""
        from sceneql.flows.varying.fluid_layout import WEIGHT

        flow = assembly.flow_of()
        if flow is None or not flow.varying:  # a flow that could not be made has its own diagnostic
            return
        vector = self.direction if self.acceleration is None else self.acceleration
        given, parameters = int(self.acceleration is not None), (assembly.value(vector), assembly.value(self.strength))
        ints = (given, *parameters, flow.varying[WEIGHT])
        assembly.term("force", "sceneql.words.forces.gravity_weight_kernels:weigh", ints)
        assembly.remember(given, *parameters)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Minus the sum of m g . x [J]."""
        from sceneql.bodies import bodies as masses
        from sceneql.words.forces.gravity_kernels import acceleration

        given, vector_at, strength_at = state.ints
        g = acceleration(state.floats, given, vector_at, strength_at)
        return -float(masses.weighed(bodies, state) @ (masses.positions(bodies, state) @ g))
