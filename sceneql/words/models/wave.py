"""wave: oscillations of a surface or a field by the wave equation on a grid."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from sceneql import kinds
from sceneql.grids.medium import (
    ANY,
    PLACE,
    SIZES,
    START,
    VALUE,
    Boundary,
    FieldLayout,
    Medium,
    Part,
    Picture,
    largest_in,
    layout_of,
    number_in,
    spacing_of,
)
from sceneql.kinds import Formula, Gives, Problem, Record, Symbols, Value, field, quantity_type
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.expression import Link, Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, ModelState

UNITS = {"height": dim.LENGTH, "number": dim.PLAIN}
NAMES = {"height": "height", "number": "value"}
PLACES = ("x", "y", "z")


class Edge(Record):
    """What holds on a part of the boundary: one of value, periodic, open."""

    value: VALUE | None = field("The value there, by place and time: 0 where a drum is held.", None)
    periodic: bool = field("The sides of this direction are one: what leaves here comes in at the other.", False)
    open: bool = field("Waves go out, du/dt = -speed du/dn: whole where they come in straight.", False)
    where: PLACE | None = field("Only where this formula is above 0.", None)
    near: SIZES | None = field("Only around this place, of two or three numbers.", None)
    within: kinds.FixedLength | None = field("How far around it.", None, above=0)

    def problems(self) -> Iterable[Problem]:
        """Errors: more than one condition, or none; a place without its size."""
        if sum((self.value is not None, self.periodic, self.open)) != 1:
            yield Problem("a part of a wave's boundary has one of `value`, `periodic` and `open`")
        else:
            yield from self.part().problems()

    def part(self) -> Part:
        """The same of a field that spreads."""
        told = {name: getattr(self, name) for name in type(self).model_fields}
        return Part.model_construct(**told)

    @property
    def span(self) -> Span | None:
        """Its line in the script, where a formula tells it."""
        return self.part().span


class Wave(Medium):
    """The wave equation d²u/dt² = div(c² grad u) - 2 damping du/dt + source by finite volumes on a grid of cells.

    With a constant c it is the equation of a membrane or of sound in a room; with c² = g times the depth, of long waves
    on water, whose volume it keeps. Where nothing is said of the boundary waves are thrown back upright (the shore of a
    pond: du/dn = 0); `value: 0` holds an edge, and `open` lets waves out (Engquist & Majda 1977, Math. Comp. 31,
    629-651, the first of their conditions). Cells are cut as those of `diffusion`. In formulas x, y, z, t and the field
    c are plain numbers in SI. Explicit solvers are stable up to a step of cell/(c sqrt(2)) or so, `verlet` and
    `implicit_midpoint` keep the energy where nothing is damped. Source: d'Alembert (1747); Strikwerda, Finite
    Difference Schemes (2004), chapter 8.

    A pond with waves as water has them: `pond: {wave: {size: 4 3 m, cell: 4 cm, speed: 1 m/s, initial:
    0.1*exp(-((x-2)^2 + (y-1)^2)/0.05)}}`, seen by `water: {field_map: {of: pond.height, height: 1, colors: none,
    material: {mirror: {color: "#456"}}}}`.
    """

    swinging: ClassVar[tuple[str, ...]] = (*NAMES.values(), "velocity")
    """Fields among its outputs that swing about 0."""

    measures: ClassVar[tuple[str, ...]] = (*NAMES.values(), "velocity", "volume", "energy")

    of: Literal["height", "number"] = field(
        "What swings: a height, the output `height`; or a number, `value`.", "height"
    )
    speed: Annotated[Formula, Symbols(PLACES, dim.VELOCITY, at_start=True)] = field("The speed c of waves.")
    initial: START | Picture | None = field("The field at the start, a formula or a picture; by default 0.", None)
    velocity: Annotated[Formula, Symbols(PLACES, dim.FREQUENCY, of_field=True, at_start=True)] | None = field(
        "How fast it changes at the start; by default 0.", None
    )
    damping: Annotated[Formula, Symbols(PLACES, dim.FREQUENCY, at_start=True)] | None = field(
        "How fast amplitudes decay, by place; by default 0.", None
    )
    source: Annotated[Formula, Symbols(ANY, dim.FREQUENCY * dim.FREQUENCY, of_field=True)] | None = field(
        "An acceleration besides, by place, time and the field.", None
    )
    boundary: dict[str, Edge] = field(
        "What holds on the sides `left`, `right` (x), `bottom`, `top` (y), `back`, `front` (z) of a box, on the pieces "
        "of an outline, on the boundary of another object by its name, on any part `where` a formula holds or `near` a "
        "place, or on `rest`.",
        {},
    )

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """In the unit of what swings."""
        what = str(written.get("of", "height"))
        unit = UNITS.get(what, dim.PLAIN)
        one, many = quantity_type(unit), quantity_type(unit, (None,))
        fast = quantity_type(unit * dim.FREQUENCY, (None,))
        probes = written.get("probes")
        named = probes if isinstance(probes, Mapping) else ()
        square = unit * unit * dim.FREQUENCY * dim.FREQUENCY * dim.VOLUME
        return {
            NAMES.get(what, "value"): Gives(many, "The field in every cell of the domain."),
            "velocity": Gives(fast, "How fast it changes in every cell."),
            "centers": Gives(quantity_type(dim.LENGTH, (None, 3)), "The centers of these cells.", computed=True),
            "volume": Gives(quantity_type(unit * dim.VOLUME), "The field times the volume of cells.", computed=True),
            "energy": Gives(
                quantity_type(square),
                "Half the integral of (du/dt)² + c² |grad u|²: of a membrane by its mass to the volume.",
                computed=True,
            ),
            "max": Gives(one, "Largest value.", computed=True),
            "min": Gives(one, "Least value.", computed=True),
            "mean": Gives(one, "Mean over the volume.", computed=True),
            **{name: Gives(one, "The value of the cell there.") for name in map(str, named)},
        }

    @classmethod
    def formula_dimension(cls, written: Mapping[str, Any]) -> Dimension | None:
        """That of what swings."""
        return UNITS.get(str(written.get("of", "height")))

    def boundaries(self) -> Iterable[Boundary]:
        """That of its field."""
        return ({name: edge.part() for name, edge in self.boundary.items()},)

    def conserves(self) -> tuple[str, ...]:
        """Its energy, where nothing is damped, goes out or comes in."""
        still = self.damping is None and self.source is None
        held = all(not edge.open and (edge.value is None or edge.value.constant) for edge in self.boundary.values())
        return ("energy",) if still and held else ()

    def problems(self) -> Iterable[Problem]:
        """Besides those of any medium, speeds and dampings below 0."""
        yield from super().problems()
        for name in ("speed", "damping"):
            number = number_in(getattr(self, name))
            if number is not None and number < 0.0:
                yield Problem(f"the {name} must be at least 0, and is {number:g}", (name,), code="out-of-range")

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """The checkerboard's oscillation, at most 2 c times the root of the sum of 1/spacing^2."""
        speed, damping = number_in(self.speed), number_in(self.damping) if self.damping is not None else 0.0
        if speed is None and self.size is not None:
            speed = largest_in(self.speed, self.corner or (0.0,) * len(self.size), self.size)
        if not speed:
            return
        spacing = spacing_of(self, scene)
        frequency = 2.0 * abs(speed) * math.sqrt(sum(1.0 / side**2 for side in spacing))
        what = f"the waves over cells of {self.cell:g} m"
        yield Oscillation(frequency, 2.0 * (damping or 0.0), what, ("cell",))

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve two numbers a cell, and add the term of the rate. Raises ScriptError."""
        from sceneql.grids.domain.domain import cells_of
        from sceneql.grids.ground import Ground
        from sceneql.waves.assembly import add_wave

        ground = Ground(cells_of(self, assembly), assembly)
        (boundary,) = self.boundaries()
        at, *energy = add_wave(self, boundary, ground, assembly)
        assembly.remember(at, *ground.memory, *energy)
        self.must_hold_probes(layout_of(at, ground.memory, assembly.numbers()), assembly)

    def layout(self, state: ModelState, output: str = "height") -> FieldLayout:
        """Where its field lies, or its velocity, for pictures."""
        layout = layout_of(state.ints[0], state.ints[1:], state.floats)
        if output != "velocity":
            return layout
        return layout_of(layout.at + layout.count + 1, state.ints[1:], state.floats)

    def shows(self, name: str) -> Value | None:
        """The field."""
        return Value(Link(name, NAMES[self.of], Type((None,), UNITS[self.of])))

    def read(self, output: str, state: ModelState) -> Any:
        """An output: (cells of the domain,), (cells, 3) or float."""
        if output == "energy":
            return sum(self._energies(state))
        layout = self.layout(state, output)
        return self.measure(self._measured(output), layout, state)

    def size_of(self, output: str, state: ModelState) -> Any:
        """The sum of the magnitudes of its energies."""
        return sum(map(abs, self._energies(state)))

    def _energies(self, state: ModelState) -> tuple[float, ...]:
        from sceneql.waves.assembly import energies

        layout = self.layout(state)
        volumes: Floats = state.floats[layout.volumes_at : layout.volumes_at + layout.count]
        return energies(layout.at, state.ints[6:], layout.shape, volumes, state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the cells, and of probes."""
        return self.places_of(self._measured(output), self.layout(state, output), state)

    def _measured(self, output: str) -> str:
        """Name of an output among a medium's measures."""
        if output in (NAMES[self.of], "velocity"):
            return "field"
        return "mass" if output == "volume" else output
