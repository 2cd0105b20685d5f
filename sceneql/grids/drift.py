"""Script fields of a drift, a flow that advects a field."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Annotated, Literal

from sceneql.kinds import Formula, ModelRef, Problem, Record, Scalar, Symbols, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Symbol

VELOCITY = Annotated[Formula, Symbols(("x", "y", "z"), dim.VELOCITY, at_start=True, several=True)]
STREAM = Annotated[Formula, Symbols(("x", "y", "z"), dim.AREA / dim.TIME, at_start=True)]
SAMPLES = {2: 24, 3: 8}
"""Samples of a flow along each side of a 2D or 3D box, before the run."""
LIMITED = 4.0
"""Factor of sum |v|/spacing in the rate that bounds explicit steps by h rate = 2. With limiters the explicit Euler
method creates no new extrema up to h sum |v|/spacing = 1/2 (Sweby 1984), without limiter up to twice that."""


class Drift(Record):
    """A flow that carries the field: its velocity v, or of a flat one its stream function, v = (ds/dy, -ds/dx), or the
    model that is this flow.

    An incompressible flow is made so within the domain: what of it would run through closed walls, or gather anywhere,
    is taken away by the gradient of a potential. Then no limiter lets new extrema arise. Through the boundary it goes
    where a `value` is given, as the formula says, and where it is `open`, as the rest of the flow needs it.
    """

    velocity: VELOCITY | None = field("The velocity [m/s]: a vector with a component for each side.", None)
    stream_function: STREAM | None = field("The stream function [m^2/s].", None)
    by: ModelRef | None = field("A `flow` in the same box that is solved with the field: it carries it.", None)
    strength: Scalar = field("A factor of it, which may vary in time.", "1")
    incompressible: bool = field("Make it free of divergence; else what runs against a wall piles up there.", True)
    limiter: Literal["koren", "van_leer", "none"] = field(
        "What values faces carry: limited ones of order 3 or 2 where the field is smooth, or the upstream cell's.",
        "koren",
    )

    @property
    def formula(self) -> Formula:
        """The given formula, of velocity or stream function."""
        formula = self.velocity or self.stream_function
        assert formula is not None
        return formula

    def problems(self) -> Iterable[Problem]:
        """Problems: not exactly one of velocity, stream function and `by`; wrong number of components."""
        if sum(one is not None for one in (self.velocity, self.stream_function, self.by)) != 1:
            yield Problem("a drift has one of `velocity`, `stream_function` and `by`")
        elif self.by is not None:
            if not self.incompressible or not self.strength.constant or float(self.strength.number()) != 1.0:
                yield Problem("a flow that is solved carries as it is: `strength` and `incompressible` are of others")
        elif self.velocity is not None and self.velocity.expr.type.shape not in ((2,), (3,)):
            yield Problem("a velocity is a vector of two or three formulas, `[-y, x]`", ("velocity",))

    def components(self) -> tuple[Expr, ...]:
        """The two or three components of the velocity, as scalar expressions."""
        if self.velocity is not None:
            return components(self.velocity.expr)
        (stream,) = components(self.formula.expr)
        return differentiate(stream, Symbol("y")), Call("neg", (differentiate(stream, Symbol("x")),))

    def fastest(self, corner: Sequence[float], size: Sequence[float], spacing: Sequence[float]) -> float:
        """The rate [1/s] that bounds explicit steps on a box, from samples of the velocity; 0 where it is unknown."""
        if self.by is not None or not self.strength.constant:
            return 0.0
        try:
            velocity = self.components()
        except TypeError:  # an operation without a derivative
            return 0.0
        count = SAMPLES[len(size)]
        most = 0.0
        sides = [[low + side * k / count for k in range(count + 1)] for low, side in zip(corner, size, strict=True)]
        for place in product(*sides):
            known = dict(zip(map(Symbol, "xyz"), (*place, 0.0), strict=False))
            speeds = [abs(float(evaluate(part, known))) for part in velocity]
            most = max(most, sum(speed / side for speed, side in zip(speeds, spacing, strict=True)))
        return (2.0 if self.limiter == "none" else LIMITED) * abs(float(self.strength.number())) * most
