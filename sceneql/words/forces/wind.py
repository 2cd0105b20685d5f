"""wind: drag of air that moves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import model_validator

from sceneql.island.static_rates import On, each, number
from sceneql.kinds import Damping, FixedTime, Force, Quantity, Scalar, Value, Velocity, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Wind(Force):
    """Drag of air that moves with velocity u: F = -(linear + quadratic |w|) w, w = v - u, on every mass.

    The laws are those of `drag` (Stokes 1851; Rayleigh 1876). Gusts change u everywhere at once by
    gusts |u| (n1, n2, n3), each n smooth noise of the time between -1 and 1 (a cubic spline of Philox numbers). What
    the wind does to the masses is counted in the work.
    """

    velocity: Velocity = field("How fast the air moves; it may vary in time.")
    linear: Damping = field("Force for a speed.", "0 N*s/m", at_least=0)
    quadratic: Annotated[Value, Quantity(dim.MASS / dim.LENGTH)] = field(
        "Force for a squared speed.", "0 kg/m", at_least=0
    )
    gusts: Scalar = field("Largest change of every component, as a part of the speed.", "0", at_least=0)
    period: FixedTime = field("Time between one gust and the next.", "1 s", above=0)
    seed: int = field("Seed of the gusts.", 0, at_least=0, at_most=2**32 - 1)

    @model_validator(mode="before")
    @classmethod
    def _does_something(cls, given: Any) -> Any:
        if isinstance(given, dict) and not {"linear", "quadratic"} & set(given):
            raise ValueError("wind needs a coefficient: `linear: 0.1 N*s/m`, `quadratic: 0.01 kg/m`, or both")
        return given

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """The drag of the lightest mass in the wind at its start."""
        velocity, linear, quadratic = number(self.velocity), number(self.linear), number(self.quadratic)
        for one in each(on) if velocity is not None else ():
            speed = math.dist(one.velocity or (0.0, 0.0, 0.0), velocity)
            decay = ((linear or 0.0) + 2.0 * (quadratic or 0.0) * speed) / one.mass
            yield Oscillation(0.0, decay, f"force '{name}'", ("linear",))

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, and its power to the work."""
        from sceneql.bodies import bodies as masses
        from sceneql.system import Slopes

        masses_of = (bodies.velocity_at, bodies.count, bodies.work_at, bodies.inverse_at)
        values = (self.linear, self.quadratic, self.velocity, self.gusts)
        parameters = (*(assembly.value(value) for value in values), assembly.floats([self.period]), self.seed)
        slopes = "sceneql.words.forces.wind_slopes_kernels:wind"
        kernel = "sceneql.words.forces.wind_kernels:wind"
        ints = (*masses_of, *parameters)
        places = (bodies, bodies.velocity_at)
        assembly.term(
            "force", kernel, ints, lambda: Slopes(slopes, *masses.own_blocks(*places), blocks=True), apart=True
        )
