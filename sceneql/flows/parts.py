"""Script fields of a flow's boundary, start and buoyancy, and estimates from them before a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from math import prod
from typing import Annotated, Literal

from sceneql import kinds
from sceneql.grids.domain.cells import SIDES
from sceneql.grids.medium import PLACE, SIZES, number_in
from sceneql.kinds import Formula, Problem, Quantity, Record, Symbols, Value, field
from sceneql.kinds.stable_step import StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.derivative import components
from sceneql.quantities.dimension import PLAIN, comparable
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL, Link, Symbol, walk
from sceneql.quantities.span import Span
from sceneql.quantities.units import describe, in_words

MOVING = Annotated[Formula, Symbols(("x", "y", "z", "t"), dim.VELOCITY, several=True)]
VELOCITY = Annotated[Formula, Symbols(("x", "y", "z"), dim.VELOCITY, at_start=True, several=True)]
STREAM = Annotated[Formula, Symbols(("x", "y", "z"), dim.AREA / dim.TIME, at_start=True)]
VISCOSITY = Annotated[Formula, Symbols(("x", "y", "z", "t", "c"), dim.PRESSURE * dim.TIME)]
FORCE = Annotated[Formula, Symbols(("x", "y", "z", "t"), dim.FORCE / dim.VOLUME, several=True)]


ROUNDED = 1e-9
"""Difference of inflow and outflow, relative to their sum, that counts as rounding."""
MOST_FACTORED = {2: 40_000, 3: 4_000}
"""Most cells of a 2D or 3D flow whose pressure equation is factored: its numbers are repeated in each of its terms."""


def _single(velocity: Formula | None) -> Iterable[Problem]:
    """The problem of a velocity that is one number."""
    if velocity is not None and not velocity.expr.type.shape:
        text = "this velocity needs components, one for each side of the box"
        written = "1" if velocity.span is None else velocity.span.text.strip("\"'")
        help = f"write `[{written}, 0]`, of a deep flow with one more 0"
        yield Problem(text, ("velocity",), code="wrong-shape", help=help)


class Wall(Record):
    """A wall, which fluid sticks to or slips along."""

    velocity: MOVING | None = field("How it moves along itself: a vector with a component for each side.", None)
    slip: Literal["free"] | kinds.FixedLength = field(
        "`free`: no friction; or Navier's slip length, how far behind the wall the velocity would be the wall's.",
        0.0,
        at_least=0,
    )

    def problems(self) -> Iterable[Problem]:
        """A velocity that is one number."""
        yield from _single(self.velocity)


class Inflow(Record):
    """Where the velocity is given."""

    velocity: MOVING = field("The velocity there, by place and time: `[0.3*y*(0.4 - y), 0]`.")

    def problems(self) -> Iterable[Problem]:
        """A velocity that is one number."""
        yield from _single(self.velocity)


class Outflow(Record):
    """Where the pressure is given, and fluid leaves as the rest of the flow has it."""

    pressure: Annotated[float, Quantity(dim.PRESSURE)] = field(
        "The pressure there; where fluid comes in, that of what rests outside.", 0.0
    )


class Side(Record):
    """What holds on a part of a flow's boundary: one of wall, inflow, outflow, periodic."""

    wall: Wall | None = field("A wall.", None)
    inflow: Inflow | None = field("A given velocity.", None)
    outflow: Outflow | None = field("A way out: a given pressure.", None)
    periodic: bool = field("The sides of this direction are one: what leaves here comes in at the other.", False)
    where: PLACE | None = field("Only where this formula is above 0.", None)
    near: SIZES | None = field("Only around this place, of two or three numbers.", None)
    within: kinds.FixedLength | None = field("How far around it.", None, above=0)

    def problems(self) -> Iterable[Problem]:
        """Problems: not exactly one condition; `periodic` on a part of a side; `near` without `within`."""
        if sum([*(one is not None for one in (self.wall, self.inflow, self.outflow)), self.periodic]) != 1:
            yield Problem("a side of a flow has one of `wall`, `inflow`, `outflow` and `periodic`")
        if self.periodic and self.chosen:
            yield Problem("`periodic` holds on whole sides, without `where` or `near`")
        if (self.near is None) != (self.within is None) or (self.near is not None and len(self.near) not in (2, 3)):
            yield Problem("`near` is a place of two or three numbers, and goes with `within`")

    @property
    def chosen(self) -> bool:
        """Whether it is restricted by `where` or `near`."""
        return self.where is not None or self.near is not None

    @property
    def velocity(self) -> Formula | None:
        """The given velocity of a wall or inflow; None without one."""
        part = self.wall or self.inflow
        return None if part is None else part.velocity

    @property
    def slip(self) -> float:
        """Slip length [m]: 0 for an inflow, infinite for free slip and outflow."""
        if self.inflow is not None:
            return 0.0
        return float("inf") if self.wall is None or self.wall.slip == "free" else self.wall.slip

    @property
    def span(self) -> Span | None:
        """Place of the side in the script, known from its formulas; None without any."""
        return next((one.span for one in (self.velocity, self.where) if one is not None), None)


def comes_in(boundary: Mapping[str, Side], size: Sequence[float]) -> float:
    """Net inflow [m^3/s] into a closed box with sides ``size`` [m], if all inflows are constant on whole sides.

    0 for a balanced box, one with an outflow, and where an inflow is a formula or on a part of a side.
    """
    through = [0.0]
    for name, side in boundary.items():
        given = None if side.inflow is None else side.inflow.velocity.expr
        if side.outflow is not None:
            return 0.0
        if given is None:
            continue
        if name not in SIDES or side.chosen or any(isinstance(node, Symbol | Link) for node in walk(given)):
            return 0.0
        axis, high = divmod(SIDES.index(name), 2)
        area = prod(length for k, length in enumerate(size) if k != axis)
        through.append((-1.0 if high else 1.0) * area * float(evaluate(components(given)[axis], {})))
    return sum(through) if abs(sum(through)) > ROUNDED * sum(map(abs, through)) else 0.0


class Start(Record):
    """The flow at the start."""

    velocity: VELOCITY | None = field("The velocity, which loses its divergence: a component for each side.", None)
    stream_function: STREAM | None = field("Of a flat flow the stream function s, v = (ds/dy, -ds/dx).", None)

    def problems(self) -> Iterable[Problem]:
        """Problems: both or neither of velocity and stream function."""
        if (self.velocity is None) == (self.stream_function is None):
            yield Problem("a flow starts by one of `velocity` and `stream_function`")
        elif self.stream_function is not None and self.stream_function.expr.type.shape != ():
            yield Problem("a stream function is one number at every place", ("stream_function",))


class Buoyancy(Record):
    """What a field does to the flow that carries it: -expansion (field - reference) gravity (Boussinesq 1903)."""

    by: Annotated[Value, Quantity(None, (None,))] = field("The field, in the same domain: `heat.temperature`.")
    expansion: Annotated[Value, Quantity(None)] = field(
        "The part by which density falls for a unit of the field, as `3.4e-3 1/K`; below 0 where it rises."
    )
    reference: Annotated[Value, Quantity(None)] = field("The value at which the density is the flow's.")
    gravity: kinds.Acceleration = field("Gravity.", "0 -9.81 0 m/s^2")

    def problems(self) -> Iterable[Problem]:
        """Problems: `by` that is no model's field; expansion or reference of a wrong dimension."""
        own = self.by.expr.type.dimension
        if not isinstance(self.by.expr, Link):
            yield Problem("this is the field of a model itself: `heat.temperature`", ("by",))
        elif own is not None:
            for name, wanted in (("expansion", PLAIN / own), ("reference", own)):
                has = getattr(self, name).expr.type.dimension
                if not comparable(has, wanted):
                    text = f"{name} is {describe(wanted)} here, but this is {in_words(has)}"
                    yield Problem(text, (name,), code="dimension-mismatch")


def of_field(viscosity: Formula) -> bool:
    """Whether a viscosity depends on a field, its symbol `c`."""
    return Symbol("c") in walk(viscosity.expr)


MOMENTS = 200
"""Intervals of a run in which mean velocities of solids are sampled in advance."""
SAMPLES = 12
"""Samples of a formula along each side of the box, in advance of a run."""


def fastest_turn(
    start: Start | None, boundary: Mapping[str, Side], corner: Sequence[float], size: Sequence[float],
    spacing: Sequence[float],
) -> float:  # fmt: skip
    """Largest sum of |u|/spacing [1/s] of the given velocities at the start, from samples; 0 where none is given."""
    whole = [[low + side * k / SAMPLES for k in range(SAMPLES + 1)] for low, side in zip(corner, size, strict=True)]
    given = [] if start is None or start.velocity is None else [(start.velocity, whole)]
    for name, part in boundary.items():
        if part.velocity is not None and name in SIDES[: 2 * len(size)]:
            axis, high = divmod(SIDES.index(name), 2)
            there = [corner[axis] + high * size[axis]]
            given.append((part.velocity, [there if k == axis else row for k, row in enumerate(whole)]))
    most = 0.0
    for formula, rows in given:
        if formula.expr.type.shape != (len(size),) or any(isinstance(node, Link) for node in walk(formula.expr)):
            continue
        for place in product(*rows):
            known = {Symbol(one): x for one, x in zip("xyzt", (*place, *[0.0] * (4 - len(place))), strict=True)}
            known[Symbol(TIME_SYMBOL)] = 0.0
            speeds = [abs(float(evaluate(part, known))) for part in components(formula.expr)]
            most = max(most, sum(speed / side for speed, side in zip(speeds, spacing, strict=True)))
    return most


def thickest(viscosity: Formula, corner: Sequence[float], size: Sequence[float]) -> float:
    """The viscosity [Pa s] of a flow's own fluid, for a formula the largest of samples of the box at the start.

    0 where it depends on a field, which is unknown before the run.
    """
    alone = number_in(viscosity)
    if alone is not None:
        return alone
    if of_field(viscosity):
        return 0.0
    rows = [[low + side * k / SAMPLES for k in range(SAMPLES + 1)] for low, side in zip(corner, size, strict=True)]
    found = 0.0
    for place in product(*rows):
        known = {Symbol(one): x for one, x in zip("xyzt", (*place, *[0.0] * (4 - len(place))), strict=True)}
        known[Symbol(TIME_SYMBOL)] = 0.0
        found = max(found, float(evaluate(components(viscosity.expr)[0], known)))
    return found


def fastest_solid(refs: Sequence[kinds.Ref], scene: StaticScene, spacing: Sequence[float]) -> tuple[float, str]:
    """(largest sum of |v|/spacing [1/s] of moving solids' positions, name of that solid), from samples in time.

    The fluid next to a solid is as fast. Rotation in place, and motion that depends on other parts, is not included.
    """
    most, of = 0.0, ""
    for ref in refs:
        position = getattr(scene.objects.get(ref.name), "position", None)
        if not isinstance(position, Value) or position.constant or position.links:
            continue
        step = scene.end / MOMENTS
        for k in range(MOMENTS if step > 0.0 else 0):
            before, after = (_placed(position, (k + part) * step) for part in (0.25, 0.75))
            turn = sum(abs(b - a) / (0.5 * step * side) for a, b, side in zip(before, after, spacing, strict=False))
            if turn > most:
                most, of = turn, ref.name
    return most, of


def _placed(position: Value, time: float) -> tuple[float, ...]:
    """The position [m] at a time [s]."""
    found = evaluate(position.expr, lambda node: time if isinstance(node, Symbol) else {}[node])
    return tuple(map(float, found))
