"""repulsion: masses push each other away at short range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar

from sceneql.island.static_rates import On, number, pulled
from sceneql.kinds import FixedLength, FixedScalar, Force, Quantity, Value, field
from sceneql.kinds.stable_step import Oscillation, StaticMass
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Assembly, Bodies, ModelState


class Repulsion(Force):
    """Masses nearer than ``range`` push each other away with F = strength (1 - r/range)^exponent.

    The energy of a pair is strength range/(exponent + 1) (1 - r/range)^(exponent + 1), half of it each mass's. Pairs
    are found by cell lists (Hockney & Eastwood 1981), so the cost grows with the number of masses alone. Masses at the
    same place do not move each other, by symmetry.
    """

    mutual: ClassVar[bool] = True

    strength: Annotated[Value, Quantity(dim.FORCE)] = field("Force at no distance.", "1 N", at_least=0)
    range: FixedLength = field("Distance at which it ends.", "0.1 m", above=0)
    exponent: FixedScalar = field("How it fades: 1 linearly, more the softer.", "1", at_least=1, at_most=20)

    def internal(self) -> bool:
        """Between masses alone."""
        return True

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """Two masses along their line, as if each pair was alone."""
        strength = number(self.strength)
        if strength is None:
            return

        def square(a: StaticMass, b: StaticMass) -> float:
            rest = 1.0 - math.dist(a.position or (), b.position or ()) / self.range
            stiffness = strength * self.exponent / self.range * max(rest, 0.0) ** (self.exponent - 1.0)
            return float(stiffness * (a.inverse + b.inverse)) if rest > 0.0 else 0.0

        yield from pulled(square, on, f"force '{name}'", "strength")

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the forces between all masses."""
        import numpy as np

        from sceneql.bodies.neighbors import table
        from sceneql.compiled.threads_kernels import threads, tile_address
        from sceneql.nbody.shared_masses import integers_of
        from sceneql.words.forces.repulsion_kernels import repulsion_tile

        bodies = integers_of(everyone)
        n = bodies[0]
        size, first, second = table(n)
        energies = assembly.floats(np.zeros(n))
        ints = (
            *(assembly.value(self.strength), assembly.floats([self.range, self.exponent]), energies),
            *(assembly.floats(np.zeros(count)) for count in (3 * n, 3 * n, n, size + 1)),
            *(size, first, second, *threads(), tile_address(repulsion_tile)),
        )
        assembly.term("force", "sceneql.words.forces.repulsion_kernels:repulsion", (*ints, *bodies))
        assembly.remember(energies, *bodies)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Half the energy of every pair for each of its masses [J]."""
        from sceneql.nbody.shared_masses import first_of

        at = state.ints[0] + first_of(bodies, state.ints[1:])
        return float(state.floats[at : at + bodies.count].sum())
