"""turbulence: drag in air with random eddies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sceneql.bodies import bodies as masses
from sceneql.island.static_rates import On, number, slowed
from sceneql.kinds import Damping, FixedLength, FixedTime, FixedVelocity, Force, Speed, field
from sceneql.kinds.stable_step import Oscillation

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Turbulence(Force):
    """Drag of air full of eddies: F = -linear (v - u), with u the curl of smooth noise (Bridson et al. 2007).

    u is free of divergence: masses that go with it neither gather nor thin out. Each octave has eddies of half the
    size, 2^(-1/3) times the speed and 2^(-2/3) times the lifetime of the one before (Kolmogorov 1941). What the air
    does to the masses is counted in the work. The noise is computed in single precision.
    """

    speed: Speed = field("Root mean square of the speed of the air.", "1 m/s", at_least=0)
    size: FixedLength = field("Size of the largest eddies.", "1 m", above=0)
    octaves: int = field("Sizes of eddies, each half the one before.", 1, at_least=1, at_most=12)
    lifetime: FixedTime | None = field("Time in which eddies change; by default they stay as they are.", None, above=0)
    velocity: FixedVelocity = field("How fast the air as a whole moves, and the eddies with it.", "0 0 0 m/s")
    linear: Damping = field("Force for a speed relative to the air.", "1 N*s/m", at_least=0)
    seed: int = field("Seed of the eddies.", 0, at_least=0, at_most=2**32 - 1)

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """The drag of the lightest mass."""
        return slowed(number(self.linear), on, f"force '{name}'", "linear")

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, and its power to the work."""
        import numpy as np

        from sceneql.compiled.threads_kernels import threads, tile_address
        from sceneql.system import Slopes
        from sceneql.words.forces.turbulence_kernels import PART, turbulence_tile

        omega = 0.0 if self.lifetime is None else 1.0 / self.lifetime
        ints = (
            *(bodies.position_at, bodies.velocity_at, bodies.count, bodies.work_at, bodies.inverse_at),
            *(assembly.value(self.speed), assembly.value(self.linear), assembly.floats(self.velocity)),
            assembly.floats([self.size, omega]),
            assembly.floats(np.zeros(bodies.count // PART + 1)),
            *(self.octaves, self.seed, *threads(), tile_address(turbulence_tile)),
        )

        def slopes() -> Slopes:
            tops, lefts = masses.own_blocks(bodies, bodies.position_at)
            along = bodies.velocity_at + np.arange(3 * bodies.count)
            i, j = np.divmod(np.arange(9), 3)
            rows, columns = (np.append(at[:, None] + k, along) for at, k in ((tops, i), (lefts, j)))
            return Slopes("sceneql.words.forces.turbulence_slopes_kernels:turbulence", rows, columns)

        assembly.term("force", "sceneql.words.forces.turbulence_kernels:turbulence", ints, slopes, apart=True)
