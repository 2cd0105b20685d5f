"""wind: drag in moving air."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import model_validator

from sceneql.island.static_rates import On, each, number
from sceneql.kinds import (
    Damping,
    FixedTime,
    Force,
    ModelRef,
    Problem,
    Quantity,
    Ref,
    Scalar,
    Value,
    Velocity,
    field,
)
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


class Wind(Force):
    """Drag of air that moves with velocity u: F = -(linear + quadratic |w|) w, w = v - u, on every mass.

    The laws are those of `drag` (Stokes 1851; Rayleigh 1876). Gusts change u everywhere at once by
    gusts |u| (n1, n2, n3), each n smooth noise of the time between -1 and 1 (a cubic spline of Philox numbers). What
    the wind does to the masses is counted in the work.

    `in: air` has the air move as the `flow` that is solved: u is linear between its faces, and there is no wind outside
    its box. The flow does not feel the masses.
    """

    velocity: Velocity | None = field("How fast the air moves; it may vary in time.", None)
    in_: ModelRef | None = field("In place of a velocity: the `flow` that the masses are in.", None)
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
            raise ValueError("wind needs a coefficient: `quadratic: 0.01 kg/m`, `linear: 0.1 N*s/m`, or both")
        return given

    def problems(self) -> Iterator[Problem]:
        """Both a velocity and a flow, or neither; gusts of a flow."""
        if (self.velocity is None) == (self.in_ is None):
            yield Problem("a wind has one of `velocity` and `in`, a flow")
        elif self.in_ is not None and not (self.gusts.constant and float(self.gusts.number()) == 0.0):
            yield Problem("a flow that is solved has no gusts: they are of a `velocity`", ("gusts",))

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """The drag of the lightest mass in the wind at its start; in a flow of masses at rest relative to it."""
        linear, quadratic = number(self.linear), number(self.quadratic)
        velocity = (0.0, 0.0, 0.0) if self.velocity is None else number(self.velocity)
        if self.in_ is not None:
            quadratic = 0.0
        for one in each(on) if velocity is not None else ():
            speed = math.dist(one.velocity or (0.0, 0.0, 0.0), velocity)
            decay = ((linear or 0.0) + 2.0 * (quadratic or 0.0) * speed) / one.mass
            yield Oscillation(0.0, decay, f"force '{name}'", ("linear",))

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Add the force to every mass, and its power to the work. Raises ScriptError where `in` names no flow."""
        from sceneql.bodies import bodies as masses
        from sceneql.system import Slopes

        if self.in_ is not None:
            self._in_flow(self.in_, assembly, bodies)
            return
        assert self.velocity is not None
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

    def _in_flow(self, ref: Ref, assembly: Assembly, bodies: Bodies) -> None:
        """Let a flow drag the masses along. Raises ScriptError for a reference that is no flow."""
        from sceneql.quantities.diagnostic import Diagnostic, ScriptError

        flow = assembly.flow_of(ref.name)
        if flow is None:
            if getattr(assembly.object(ref), "flows", False):
                return  # the flow's own assembly has failed
            text = f"'{ref.name}' is no flow"
            raise ScriptError([Diagnostic("no-flow", text, ref.span, "name a model `flow`")])
        box = assembly.floats([*flow.low, *flow.spacing])
        own = (bodies.position_at, bodies.velocity_at, bodies.count, bodies.work_at, bodies.inverse_at)
        values = (assembly.value(self.linear), assembly.value(self.quadratic))
        assembly.term("force", "sceneql.flows.blowing_kernels:wind", (*own, *values, box, *flow.ints))
