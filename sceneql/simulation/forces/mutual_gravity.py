"""mutual_gravity: all masses attract one another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from sceneql.kinds import FixedLength, Force, Quantity, Value, field
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Assembly, Bodies, ModelState


class MutualGravity(Force):
    """Gravity between all masses: F = G m1 m2 / r^2 (Newton, Principia (1687), book III, proposition 7).

    With ``softening`` s the force is G m1 m2 r / (r^2 + s^2)^(3/2) (Plummer 1911; Aarseth 1963), with the potential
    -G m1 m2 / sqrt(r^2 + s^2). Half of the energy of a pair is each mass's. Every pair is summed, in one order whatever
    the number of threads.
    """

    mutual: ClassVar[bool] = True

    constant: Annotated[Value, Quantity(dim.VOLUME / dim.MASS / dim.TIME**2)] = field(
        "The constant of gravitation G.", "6.6743e-11 m^3/kg/s^2"
    )
    softening: FixedLength = field("Length below which the force no longer grows.", "0 m", at_least=0)

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the forces between all masses. Raises ScriptError where two stand at one place without softening."""
        from sceneql.simulation.nbody.pairs import Pairs

        pairs = Pairs(
            sign=1,
            constant_at=assembly.value(self.constant),
            softening=self.softening,
            weights=[(bodies.mass_at, 1) for bodies in everyone],
        )
        pairs.add(assembly, everyone, assembly.line())

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Half the energy of every pair for each of its masses [J]."""
        from sceneql.simulation.nbody.pairs import energy

        return energy(bodies, state)
