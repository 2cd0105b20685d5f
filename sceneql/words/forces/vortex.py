"""vortex: drag in air that circles around an axis."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from sceneql.island.static_rates import On, number, slowed
from sceneql.kinds import Damping, Direction, FixedLength, Force, Position, Quantity, Speed, Value, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Vortex(Force):
    """Drag of air that runs round an axis: F = -linear (v - u), u a vortex (Oseen 1911; Lamb 1932, art. 334a).

    u = circulation / (2 pi r) (1 - exp(-r^2/core^2)) around the axis, plus ``updraft`` exp(-r^2/core^2) along it. It
    turns by the right hand for a positive circulation. What it does to the masses is counted in the work.
    """

    position: Position = field("A point of the axis.", "0 0 0 m")
    axis: Direction = field("Direction of the axis; its length does not matter.", "0 1 0")
    circulation: Annotated[Value, Quantity(dim.AREA / dim.TIME)] = field("Speed times way round.", "1 m^2/s")
    core: FixedLength = field("Radius inside which the air turns nearly as a whole.", "0.5 m", above=0)
    updraft: Speed = field("Speed along the axis, on it.", "0 m/s")
    linear: Damping = field("Force for a speed relative to the air.", "1 N*s/m", at_least=0)

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """The drag of the lightest mass."""
        return slowed(number(self.linear), on, f"force '{name}'", "linear")

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, and its power to the work."""
        import numpy as np

        from sceneql.bodies import bodies as masses
        from sceneql.system import Slopes

        ints = (bodies.position_at, bodies.velocity_at, bodies.count, bodies.work_at, bodies.inverse_at)
        values = (self.position, self.axis, self.circulation, self.updraft, self.linear)
        parameters = (*(assembly.value(value) for value in values), assembly.floats([self.core]))

        def slopes() -> Slopes:
            both = (masses.own_blocks(bodies, at) for at in (bodies.position_at, bodies.velocity_at))
            rows, columns = (np.concatenate(places) for places in zip(*both, strict=True))
            return Slopes("sceneql.words.forces.vortex_slopes_kernels:vortex", rows, columns, blocks=True)

        kernel = "sceneql.words.forces.vortex_kernels:vortex"
        assembly.term("force", kernel, (*ints, *parameters), slopes, apart=True)
