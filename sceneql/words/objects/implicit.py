"""implicit: a solid given by a formula of x, y and z."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import ceil, cos, hypot, inf, isfinite, pi, sin, sqrt
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import field_validator

from sceneql.formulas.balanced import balanced
from sceneql.formulas.point_formula import in_coordinates, written_out
from sceneql.kinds import (
    Clock,
    Doubt,
    FieldBuilder,
    FixedLength,
    FixedScalar,
    Formula,
    Moment,
    Problem,
    Quantity,
    Record,
    Symbols,
)
from sceneql.kinds import field as described
from sceneql.quantities.dimension import PLAIN
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Number, Symbol
from sceneql.quantities.intervals import range_of
from sceneql.quantities.spaced import less as less_text
from sceneql.shapes.placement import inverse
from sceneql.shapes.solid import Solid, block, length, less, traced, triple

if TYPE_CHECKING:
    from sceneql import frame

Corner = tuple[float, float, float]
Place = Annotated[Corner, Quantity(PLAIN, (3,))]
PLACES = 200
"""Number of points on the default bounds at which a formula is sampled."""
AXES = tuple(tuple(side * (j == k) for j in range(3)) for k in range(3) for side in (1.0, -1.0))
"""Directions along which solids that do not end often go on."""
SMALLEST, LARGEST, WIDER = 0.25, 60.0, 1.06
"""Radii of the spheres on which a solid outside of its bounds is looked for: the ends, and the ratio of the next."""
BEYOND = 1.3
"""Ratio of two such radii between which nothing is found for the solid to end there."""
ROUNDING = 1e-9
"""Tolerance of a formula's values on the bounds, relative to those half way to them."""


class Within(Record):
    """Where the formula is looked at: a ball about the origin or a box, in units of the formula."""

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("x", "y", "z", "min", "max", "low", "high", "from", "to", "size"),
        "a box has a low and a high corner: write `bounds: {box: [-2 -2 -2, 2 2 2]}`",
    )

    ball: FixedScalar | None = described("Radius of a ball about the origin.", None, above=0)
    box: tuple[Place, Place] | None = described("Low and high corner of a box.", None)

    def problems(self) -> Iterator[Problem]:
        """Two shapes or none, or a box inside out."""
        if (self.ball is None) == (self.box is None):
            yield Problem("bounds are one of `ball: radius` and `box: [low, high]`")
        if self.box is not None and not all(low < high for low, high in zip(*self.box, strict=True)):
            text = "each component of the box's low corner must be below that of its high corner"
            yield Problem(text, ("box",))

    @property
    def corners(self) -> tuple[Corner, Corner]:
        """Low and high corner of the box around it."""
        if self.box is not None:
            return self.box
        r = self.ball or 0.0
        return (-r, -r, -r), (r, r, r)


@dataclass(frozen=True, slots=True)
class _Less:
    """Formula minus the level, at an instant."""

    formula: Expr
    """Formula minus level, divided by a power of two if its numbers would overflow."""
    alone: frame.Tape
    """Tape of the formula, in units and without bounds."""
    leveling: float
    """Power of two by which the formula is multiplied."""


def _less(formula: Expr, level: float, low: Corner, high: Corner) -> _Less:
    """Formula minus the level, for a formula without names, within the bounds low..high."""
    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.field.tape.magnitude import leveling

    formula = balanced(Call("sub", (formula, Number(level))) if level else formula)
    build = TapeBuilder()
    alone = build.finish(build.expression(formula, {"x": build.x, "y": build.y, "z": build.z}))
    return _Less(formula, alone, leveling(alone, low, high))


def _why_nothing(less: _Less, low: Corner, high: Corner) -> str:
    """Reason why a formula has no surface within the bounds low..high; empty if it may have one."""
    from sceneql.field.tape.emptiness import bottomless, nowhere_defined

    if nowhere_defined(less.alone, triple(low), triple(high)):
        return "the formula is defined nowhere in its bounds, so there is nothing to draw"
    if bottomless(less.alone, low, high):
        return "the formula is nowhere finite in its bounds, so there is no surface to draw"
    return ""


def _on_a_ball(count: int) -> Iterator[tuple[float, float, float]]:
    """Points evenly on the unit sphere, on the Fibonacci spiral (Gonzalez 2010)."""
    for k in range(count):
        z, turn = 1.0 - (2 * k + 1) / count, pi * (3.0 - sqrt(5.0)) * k
        aside = sqrt(1.0 - z * z)
        yield aside * cos(turn), aside * sin(turn), z


def _compared(expr: Expr) -> str | None:
    """The formula below 0 where a comparison holds, or several joined by products or `max`; None of another formula."""
    if not isinstance(expr, Call) or any(arg.span is None for arg in expr.args):
        return None
    if expr.op in ("mul", "max", "add"):
        each = [_compared(arg) for arg in expr.args]
        known = [one for one in each if one is not None]
        return f"{'max' if expr.op == 'mul' else 'min'}({', '.join(known)})" if len(known) == len(each) else None
    first, *others = (arg.span.text for arg in expr.args if arg.span is not None)
    if expr.op not in ("lt", "le", "gt", "ge", "eq") or len(others) != 1:
        return None
    return less_text(others[0], first) if expr.op in ("gt", "ge") else less_text(first, others[0])


class Implicit(Solid):
    """The solid {field < level} within its bounds, or the surface {field = level}.

    The formula takes plain numbers x, y, z and the time t in seconds; x = 1 stands for the length `unit`, so textbook
    formulas need no dimensions. Where the formula is not defined is outside. Its field is max(unit (field - level),
    distance to the bounds), which is negative inside but is a distance only where |grad field| = 1.

    As a surface it is drawn as a thin sheet, seen from both sides and open at its bounds, also where the field touches
    the level and does not pass it, as (x^2 + y^2 - 1)^2 does 0; to contacts, meshes and other objects it is the solid.
    """

    edgeless: ClassVar[bool] = True

    field: Annotated[Formula, Symbols(("x", "y", "z", "t"), PLAIN)] = described("The formula.")
    level: FixedScalar = described("The value that the formula has on the surface.", "0")
    unit: FixedLength = described("The length that x = 1 stands for.", "1 m", above=0)
    bounds: Within = described(
        "Where the formula is looked at, in units of the formula; by default the ball of radius 1.", Within(ball=1.0)
    )
    mode: Literal["solid", "surface"] = described(
        "`solid`: all that is below the level; `surface`: a sheet where it is reached.", "solid"
    )

    @field_validator("field")
    @classmethod
    def _is_scalar(cls, given: Formula) -> Formula:
        in_coordinates(given.expr)
        return given

    def problems(self) -> Iterator[Problem]:
        """A comparison, which is 1 or 0 and has no surface."""
        if (meant := _compared(self.field.expr)) is not None:
            text = "a comparison is 1 or 0, and no formula of a surface, which is below the level inside"
            yield Problem(text, ("field",), code="no-surface", help=f"write `{meant}`")

    def doubts(self, clock: Clock) -> Iterator[Doubt]:
        """A formula that certainly does not come down to the level within its bounds."""
        yield from super().doubts(clock)
        sides = dict(zip("xyz", zip(*self.bounds.corners, strict=True), strict=True))
        low, high = range_of(self.field.expr, sides)
        if low > self.level or (self.mode == "surface" and high < self.level):
            found = f"at least {low:.4g}" if low > self.level else f"at most {high:.4g}"
            text = (
                f"it is empty: within its bounds the formula is {found}, and its surface is where it is {self.level:g}"
            )
            help = "inside the formula is below the level: turn its sign round, subtract more, or set `level`"
            first, reach = self._found_at()
            if reach is not None:
                help = f"its surface lies outside of its bounds: write `bounds: {{ball: {reach:.3g}}}`"
            elif first is not None:
                help = f"its surface lies outside of its bounds: write larger `bounds`, as `{{ball: {4 * first:.2g}}}`"
            yield Doubt("empty-surface", text, self.field.span, help)
        elif "bounds" not in self.model_fields_set:
            first, reach = self._found_at(stop=1.0)
            if first is not None:
                text = "its surface lies outside of its bounds, which are the ball of radius 1 by default"
                help = "inside the formula is below the level: turn its sign round, or write larger `bounds`"
                help = help if reach is None else f"write `bounds: {{ball: {reach:.3g}}}`"
                yield Doubt("empty-surface", text, self.field.span, help)

    def _found_at(self, stop: float = 0.0) -> tuple[float | None, float | None]:
        """The least radius of a sphere about the origin that the solid comes to at the start, and of one around it.

        None where it comes to none, does not end, or the formula reads values known only in a run; both None, too,
        where it comes to one up to the radius ``stop``.
        """
        first, last, radius = None, 0.0, SMALLEST
        while radius < LARGEST:
            try:
                within = self._least_on(radius) < self.level
            except (AttributeError, KeyError, ArithmeticError):
                return None, None
            if within and radius <= stop:
                return None, None
            if within:
                first, last = first or radius, radius
            elif first is not None and radius > BEYOND * last:
                return first, ceil(100 * WIDER * last) / 100
            radius *= WIDER
        return first, None

    def _least_on(self, radius: float) -> float:
        """The least value of the formula at places on a sphere about the origin, at the start."""
        known: dict[str, float] = {"t": 0.0}

        def look_up(node: Symbol) -> float:
            return known[node.name]

        least = inf
        for place in (*AXES, *_on_a_ball(PLACES)):
            known |= zip("xyz", (radius * c for c in place), strict=True)
            value = evaluate(self.field.expr, look_up)
            least = min(least, value if isfinite(value) else inf)
        return least

    def cut_by_default(self, flat: bool = False) -> tuple[str, str]:
        """The ball about the origin, where no bounds are given and the solid or surface goes on there at the start."""
        if "bounds" in self.model_fields_set:
            return "", ""
        low, high, size = inf, -inf, 0.0
        known: dict[str, float] = {}

        def look_up(node: Symbol) -> float:
            return known[node.name]

        for place in _on_a_ball(PLACES):
            if flat:
                wide = hypot(*place[:2])
                place = (place[0] / wide, place[1] / wide, 0.0)
            try:
                known |= zip("xyzt", (*(0.5 * x for x in place), 0.0), strict=True)
                within = evaluate(self.field.expr, look_up)
                known |= zip("xyzt", (*place, 0.0), strict=True)
                value = evaluate(self.field.expr, look_up)
            except (AttributeError, KeyError):  # the formula reads values known only in a run
                return "", ""
            low, high = min(low, value), max(high, value)
            size = max(size, abs(within - self.level) if isfinite(within) else 0.0)
        # A formula of the same ball is below the level on the bounds by rounding alone.
        goes_on = low < self.level - ROUNDING * size and (self.mode == "solid" or high > self.level + ROUNDING * size)
        if not goes_on:
            return "", ""
        _, reach = self._found_at()
        return "the ball x^2 + y^2 + z^2 = 1", "" if reach is None else f"bounds: {{ball: {reach:.3g}}}"

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """The formula and its bounds, in meters."""
        return build.op("mul", build.op("max", *self._parts(build, x, y, z, moment)), build.constant(self.unit))

    def _parts(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> tuple[int, int]:
        """Registers of the formula minus the level, and of the distance to the bounds, in units.

        A formula much larger or smaller than distances is scaled by a power of two. Otherwise its values near 0, at the
        level of rounding, could be smaller than the distances to its bounds and to other objects, or hide them.
        """
        per_unit = build.constant(1.0 / self.unit)
        u, v, w = (build.op("mul", register, per_unit) for register in (x, y, z))
        now = self._now(moment)
        value = build.expression(now.formula, {"x": u, "y": v, "z": w})
        value = build.op("mul", value, build.constant(now.leveling))
        if self.bounds.ball is not None:
            limit = less(build, length(build, u, v, w), self.bounds.ball)
        else:
            limit = block(build, (u, v, w), *self.bounds.corners)
        return value, limit

    def _now(self, moment: Moment) -> _Less:
        """Formula minus the level now; for a constant formula it is made once."""

        def make() -> _Less:
            return _less(written_out(self.field.expr, moment), self.level, *self.bounds.corners)

        return self.field.kept((self.level, self.bounds.corners), make) if self.field.constant else make()

    def _why_nothing(self, moment: Moment) -> str:
        """Reason why there is nothing to draw at any time; empty if there may be something."""
        if not self.field.constant:
            return ""
        key, less = (self.level, self.bounds.corners), self._now(moment)
        return moment.kept(f"nothing {id(self.field)}", key, lambda: _why_nothing(less, *self.bounds.corners))

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """The box around its bounds."""
        low, high = self.bounds.corners
        return tuple(self.unit * c for c in low), tuple(self.unit * c for c in high)

    def lower(self, name: str, place: frame.Floats, moment: Moment) -> Iterable[frame.Shape]:
        """Its tape in the box around its bounds.

        Raises RunFailure where the formula is nowhere defined there, or nowhere finite and yet inside, at any time.
        """
        from sceneql.failure import RunFailure

        for solid in traced(self, name, place, moment):
            shape = solid if self.mode == "solid" else self._sheet(solid, place, moment)
            message = self._why_nothing(moment)
            if message:
                raise RunFailure(message, part="field", time=moment.time, span=self.field.span)
            yield shape

    def _sheet(self, solid: frame.Implicit, place: frame.Floats, moment: Moment) -> frame.Implicit:
        """Sheet on the surface of the solid."""
        from sceneql.field.tape.builder import TapeBuilder

        build = TapeBuilder()
        world = build.affine(inverse(place), build.x, build.y, build.z)
        value, limit = self._parts(build, *build.affine(inverse(self.local(moment)), *world), moment)
        return replace(solid, tape=build.finish(value), within=build.finish(limit))
