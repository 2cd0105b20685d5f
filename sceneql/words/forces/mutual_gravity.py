"""mutual_gravity: all masses attract one another."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from sceneql.island.static_rates import On, number, pulled
from sceneql.kinds import FixedLength, FixedScalar, Force, Quantity, Value, field
from sceneql.kinds.stable_step import Oscillation, StaticMass
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Assembly, Bodies, ModelState


class MutualGravity(Force):
    """Gravity between all masses: F = G m1 m2 / r^2 (Newton, Principia (1687), book III, proposition 7).

    With ``softening`` s the force is G m1 m2 r / (r^2 + s^2)^(3/2) (Plummer 1911; Aarseth 1963), with the potential
    -G m1 m2 / sqrt(r^2 + s^2). Half of the energy of a pair is each mass's. Up to some
    thousand masses every pair is summed; above, a tree (Barnes & Hut 1986) takes groups of masses from afar by their
    moments up to the second: those whose radius is seen under less than the angle ``opening``. All sums have one order,
    whatever the number of threads.
    """

    mutual: ClassVar[bool] = True

    constant: Annotated[Value, Quantity(dim.VOLUME / dim.MASS / dim.TIME**2)] = field(
        "The constant of gravitation G.", "6.6743e-11 m^3/kg/s^2"
    )
    softening: FixedLength = field("Length below which the force no longer grows.", "0 m", at_least=0)
    method: Literal["auto", "direct", "tree"] = field("How it is summed.", "auto")
    accuracy: Literal["full", "fast"] = field(
        "`fast` sums every pair in single precision: some 1.5 times as quick, and off by some 1e-7, which `explain` "
        "samples. A tree stays as it is.",
        "full",
    )
    opening: FixedScalar = field(
        "Angle [rad] from which on the tree opens a group; 0.65 gives errors of some 1e-3.", "0.65", above=0, at_most=1
    )

    def at_a_distance(self) -> bool:
        """Smooth wherever no two masses meet."""
        return self.method != "tree" and self.accuracy == "full"

    def darkens(self) -> bool:
        """Heavenly bodies."""
        return True

    def internal(self) -> bool:
        """Between masses alone."""
        return True

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """Two masses round each other, as if each pair was alone."""
        constant = number(self.constant)
        if constant is None:
            return

        def square(a: StaticMass, b: StaticMass) -> float:
            rho = math.hypot(math.dist(a.position or (), b.position or ()), self.softening)
            return float(constant * (a.mass * (not b.fixed) + b.mass * (not a.fixed)) / rho**3)

        yield from pulled(square, on, f"force '{name}'", "constant")

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the forces between all masses. Raises ScriptError where two stand at one place without softening."""
        from sceneql.nbody.pairs import MOST_DIRECT, Pairs

        count = sum(bodies.count for bodies in everyone)
        tree = self.method == "tree" or (self.method == "auto" and count > MOST_DIRECT)
        pairs = Pairs(
            sign=1,
            constant_at=assembly.value(self.constant),
            softening=self.softening,
            opening=self.opening if tree else 0.0,
            weights=[(bodies.mass_at, 1) for bodies in everyone],
            fast=self.accuracy == "fast",
        )
        pairs.add(assembly, everyone, assembly.line())

    def remark(self, state: ModelState) -> str:
        """How it is summed; of a tree the error at the start, sampled."""
        from sceneql.nbody.pairs import SAMPLES, sampled_error

        if not state.ints[0] and self.accuracy == "full":
            return "every pair is summed"
        typical, worst = sampled_error(state)
        how = f"a tree with opening {self.opening:g}" if state.ints[0] else "every pair is summed in single precision"
        return (
            f"{how}; of {SAMPLES} masses sampled at the start the force is off by "
            f"{typical:.1e} (root mean square), {worst:.1e} at most"
        )

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Half the energy of every pair for each of its masses [J]."""
        from sceneql.nbody.pairs import energy

        return energy(bodies, state)
