"""attractor: a pull towards a point."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.island.static_rates import On, each, number
from sceneql.kinds import FixedLength, FixedScalar, Force, Position, Quantity, Value, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState


class Attractor(Force):
    """A pull towards a point by a power of the distance: a = (strength / l^2) (l/r)^exponent with l = 1 m.

    With exponent 2 it is the gravity of a body of G M = strength (Newton, Principia (1687), book I, proposition 11);
    with -1 a spring. With ``softening`` s, r becomes sqrt(r^2 + s^2) in the size of the force, and the direction is
    scaled by r over that (Plummer 1911). At the point itself the pull is zero, by symmetry. A negative strength repels.
    """

    position: Position = field("Where it pulls to.", "0 0 0 m")
    strength: Annotated[Value, Quantity(dim.VOLUME / dim.TIME**2)] = field("G M of the pulling body.", "1 m^3/s^2")
    exponent: FixedScalar = field("Power of the distance that it falls with.", "2", at_least=-10, at_most=10)
    softening: FixedLength = field("Length below which the pull no longer grows.", "0 m", at_least=0)

    def darkens(self) -> bool:
        """The gravity of a body; another power is none."""
        return self.exponent == 2

    def at_a_distance(self) -> bool:
        """Smooth wherever no two masses meet."""
        return True

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """Swings across the pull and, where it grows with the distance, along it."""
        strength, center = number(self.strength), number(self.position)
        for one in each(on) if strength is not None and center is not None else ():
            away = math.dist(one.position, center) if one.position is not None else 0.0
            if away > 0.0:
                rho = math.hypot(away, self.softening)
                across = strength / rho ** (self.exponent + 1)
                along = across * (1.0 - (self.exponent + 1) * (away / rho) ** 2)
                yield Oscillation(math.sqrt(max(across, along, 0.0)), 0.0, f"force '{name}'", ("strength",))

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the pull on every mass."""
        from sceneql.bodies import bodies as masses
        from sceneql.system import Slopes

        ints = (bodies.position_at, bodies.velocity_at, bodies.count, bodies.mass_at)
        parameters = (
            assembly.value(self.position),
            assembly.value(self.strength),
            assembly.floats([self.exponent, self.softening]),
        )
        slopes = "sceneql.words.forces.attractor_slopes_kernels:attractor"
        assembly.term(
            "force",
            "sceneql.words.forces.attractor_kernels:attractor",
            (*ints, *parameters),
            lambda: Slopes(slopes, *masses.own_blocks(bodies, bodies.position_at), blocks=True),
            apart=True,
        )
        assembly.remember(*parameters)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Sum of m phi with phi = -strength / ((p - 1) rho^(p-1)), or strength ln rho for exponent p = 1 [J]."""
        import numpy as np

        from sceneql.bodies import bodies as masses

        position_at, strength_at, shape_at = state.ints
        away = masses.positions(bodies, state) - state.floats[position_at : position_at + 3]
        p, softening = state.floats[shape_at], state.floats[shape_at + 1]
        moving = masses.moving_masses(bodies, state) > 0
        rho = np.sqrt(np.sum(away[moving] ** 2, axis=1) + softening**2)
        with np.errstate(divide="ignore"):  # the logarithm is minus infinity at the point itself
            phi = np.log(rho) if p == 1 else -(rho ** (1 - p)) / (p - 1)
        return float(state.floats[strength_at] * (masses.masses(bodies, state)[moving] @ phi))
