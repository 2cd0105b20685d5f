"""electrostatic: charges act on one another."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

from sceneql.bodies.charges import Charges, each_of_all
from sceneql.island.static_rates import On, number, pulled
from sceneql.kinds import FixedLength, Force, Quantity, Value, field
from sceneql.kinds.stable_step import Oscillation, StaticMass
from sceneql.quantities import dimension as dim
from sceneql.quantities.unit_table import CHARGE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Assembly, Bodies, ModelState


class Electrostatic(Force):
    """Forces between charges: F = k q1 q2 / r^2, away from each other where the signs are equal (Coulomb 1785).

    k is 1/(4 pi epsilon_0). With ``softening`` s the potential energy is k q1 q2 / sqrt(r^2 + s^2); half of the energy
    of a pair is each charge's. Magnetic forces between the moving charges are left out.
    """

    mutual: ClassVar[bool] = True

    charge: Charges = field(
        "Charge of every mass, or a list with one for each, those of the first model first (the order of `on`)."
    )
    constant: Annotated[Value, Quantity(dim.FORCE * dim.AREA / CHARGE**2)] = field(
        "Coulomb's constant k.", "8.9875517862e9 N*m^2/C^2"
    )
    softening: FixedLength = field("Length below which the force no longer grows.", "0 m", at_least=0)

    def darkens(self) -> bool:
        """Charges in a vacuum."""
        return True

    def internal(self) -> bool:
        """Between masses alone."""
        return True

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """Two charges, as if each pair was alone: round each other, or along their line where they repel."""
        charge, constant = number(self.charge), number(self.constant)
        if constant is None or not isinstance(charge, float | int):
            return

        def square(a: StaticMass, b: StaticMass) -> float:
            away = math.dist(a.position or (), b.position or ())
            rho = math.hypot(away, self.softening)
            stiffness = constant * charge**2 / rho**3 * (3.0 * (away / rho) ** 2 - 1.0)
            return float(stiffness * (a.inverse + b.inverse))

        yield from pulled(square, on, f"force '{name}'", "charge")

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the forces between all charges. Raises ScriptError where two stand at one place without softening."""
        from sceneql.nbody.pairs import Pairs

        pairs = Pairs(
            sign=-1,
            constant_at=assembly.value(self.constant),
            softening=self.softening,
            opening=0.0,
            weights=each_of_all(assembly, self.charge, [bodies.count for bodies in everyone], "charge"),
        )
        pairs.add(assembly, everyone, assembly.line())

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Half the energy of every pair for each of its charges [J]."""
        from sceneql.nbody.pairs import energy

        return energy(bodies, state)
