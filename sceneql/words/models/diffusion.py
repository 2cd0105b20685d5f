"""diffusion: a concentration or temperature that spreads through a domain."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

from sceneql.grids.medium import (
    SOURCE,
    START,
    Boundary,
    FieldLayout,
    Picture,
    gives_of,
    layout_of,
)
from sceneql.grids.spreading_medium import COEFFICIENT, SpreadingMedium
from sceneql.kinds import Formula, Gives, Value, field
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.expression import Link, Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.system import Assembly, ModelState

UNITS = {"concentration": dim.DENSITY, "temperature": dim.TEMPERATURE, "number": dim.PLAIN}


def _names(what: str) -> tuple[str, ...]:
    """The names of the field among the model's values: a temperature is still read by the one that all once had."""
    return ("temperature", "concentration") if what == "temperature" else ("concentration",)


class Diffusion(SpreadingMedium):
    """Diffusion dc/dt = div(D grad c) + source by finite volumes on a grid of cells, which conserve what there is.

    A face between two cells carries D area (difference)/(distance); D there is the harmonic mean of the cells' where it
    depends on the place alone (layers in a row), else the arithmetic one. On a boundary the value, the flux, or both in
    proportion are given; where nothing is said nothing crosses. In formulas x, y, z, t and the field c are plain
    numbers in SI. A flat domain has x and y and a `depth`. Source: Patankar, Numerical Heat Transfer and Fluid Flow
    (1980), 4.2; Crank, The Mathematics of Diffusion (1975).
    """

    of: Literal["concentration", "temperature", "number"] = field(
        "What spreads, which gives its unit, and a temperature's output its name.", "concentration"
    )
    coefficient: COEFFICIENT = field("The coefficient D [m^2/s].")
    initial: START | Picture | None = field("The field at the start, a formula or a picture; by default 0.", None)
    source: SOURCE | None = field("What comes in a second and cubic meter; below 0 it leaves.", None)
    boundary: Boundary = field(
        "What holds on the sides `left`, `right` (x), `bottom`, `top` (y), `back`, `front` (z) of a box, on the pieces "
        "of an outline, on the boundary of another object by its name, on any part `where` a formula holds or `near` a "
        "place, or on `rest`.",
        {},
    )

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """In the unit of what spreads."""
        what = str(written.get("of", "concentration"))
        found = dict(gives_of("The field in every cell of the domain.", UNITS.get(what, dim.PLAIN), written))
        own = found.pop("field")
        return {**dict.fromkeys(_names(what), own), **found}

    @classmethod
    def formula_dimension(cls, written: Mapping[str, Any]) -> Dimension | None:
        """That of what spreads."""
        return UNITS.get(str(written.get("of", "concentration")))

    def field_count(self) -> int:
        """One."""
        return 1

    def boundaries(self) -> Iterable[Boundary]:
        """That of its field."""
        return (self.boundary,)

    def coefficients(self) -> Iterable[tuple[Formula | None, tuple[str, ...]]]:
        """That of its field."""
        return ((self.coefficient, ("coefficient",)),)

    @property
    def made(self) -> bool:
        """Whether it has a source."""
        return self.source is not None

    @property
    def positive(self) -> bool:
        """Whether it is a concentration."""
        return self.of == "concentration"

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """What limits the explicit step."""
        found = self.spreading(self.coefficient, scene)
        return () if found is None else (found,)

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve a number a cell and one for the inflow, and add the terms of the rate. Raises ScriptError."""
        from sceneql.grids.assembly import add_field
        from sceneql.grids.domain.domain import cells_of
        from sceneql.grids.ground import Ground

        ground = Ground(cells_of(self, assembly), assembly)
        grid = add_field(self, self.boundary, self.drift, ground, assembly)
        assembly.grid(grid)
        for called in _names(self.of):
            assembly.offer(called, grid)
        assembly.remember(grid.at, *ground.memory)
        self.must_hold_probes(layout_of(grid.at, ground.memory, assembly.numbers()), assembly)

    def connect(self, name: str, assembly: Assembly) -> None:
        """Add the drift by a flow that is solved. Raises ScriptError."""
        if self.drift is not None and self.drift.by is not None:
            from sceneql.flows.carried import carry

            grid = assembly.field_of(Link(name, _names(self.of)[0], Type((None,))))
            if grid is not None:
                carry(self, self.drift, [(grid, self.boundary)], assembly)

    def layout(self, state: ModelState, output: str = "concentration") -> FieldLayout:
        """Where its field lies, for pictures."""
        return layout_of(state.ints[0], state.ints[1:], state.floats)

    def shows(self, name: str) -> Value | None:
        """The field."""
        return Value(Link(name, _names(self.of)[0], Type((None,), UNITS[self.of])))

    def read(self, output: str, state: ModelState) -> Any:
        """An output: (cells of the domain,), (cells, 3) or float."""
        return self.measure("field" if output in _names(self.of) else output, self.layout(state), state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the cells, of probes, and of what has come in."""
        return self.places_of("field" if output in _names(self.of) else output, self.layout(state), state)
