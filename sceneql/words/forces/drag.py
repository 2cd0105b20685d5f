"""drag: a medium at rest slows the masses."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import model_validator

from sceneql.island.static_rates import On, each, number
from sceneql.kinds import Damping, Force, Quantity, Value, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Drag(Force):
    """Drag of a medium at rest: F = -(linear + quadratic |v|) v on every mass; what it takes is counted as dissipated.

    The linear part is that of a slow sphere, 6 pi eta r (Stokes 1851); the quadratic one that of a fast body,
    rho C A / 2 (Newton, Principia (1687), book II, proposition 33; Rayleigh 1876).
    """

    needs_speed: ClassVar[bool] = True

    linear: Damping = field("Force for a speed.", "0 N*s/m", at_least=0)
    quadratic: Annotated[Value, Quantity(dim.MASS / dim.LENGTH)] = field(
        "Force for a squared speed.", "0 kg/m", at_least=0
    )

    @model_validator(mode="before")
    @classmethod
    def _does_something(cls, given: Any) -> Any:
        if isinstance(given, dict) and not {"linear", "quadratic"} & set(given):
            raise ValueError("drag needs a coefficient: `linear: 0.1 N*s/m`, `quadratic: 0.01 kg/m`, or both")
        return given

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """The drag of the lightest mass at its start."""
        linear, quadratic = number(self.linear), number(self.quadratic)
        for one in each(on):
            speed = math.hypot(*(one.velocity or (0.0,)))
            decay = ((linear or 0.0) + 2.0 * (quadratic or 0.0) * speed) / one.mass
            yield Oscillation(0.0, decay, f"force '{name}'", ("linear",))

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, and its power to the dissipated energy."""
        from sceneql.bodies import bodies as masses
        from sceneql.system import Slopes

        ints = (bodies.velocity_at, bodies.count, bodies.work_at, bodies.inverse_at)
        parameters = (assembly.value(self.linear), assembly.value(self.quadratic))
        slopes = "sceneql.words.forces.drag_slopes_kernels:drag"
        assembly.term(
            "force",
            "sceneql.words.forces.drag_kernels:drag",
            (*ints, *parameters),
            lambda: Slopes(slopes, *masses.own_blocks(bodies, bodies.velocity_at), blocks=True),
            apart=True,
        )
