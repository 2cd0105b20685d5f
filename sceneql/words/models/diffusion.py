"""diffusion: a concentration or temperature that spreads through a domain."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from pydantic import PrivateAttr

from sceneql.grids.medium import (
    SOURCE,
    START,
    Boundary,
    FieldLayout,
    Picture,
    gives_of,
    layout_of,
    number_in,
)
from sceneql.grids.spreading_medium import COEFFICIENT, SpreadingMedium
from sceneql.kinds import Clock, Doubt, Formula, Gives, Problem, Value, field
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.expression import Link, Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.galerkin.element_field import ElementField
    from sceneql.grids.medium import Between
    from sceneql.system import Assembly, ModelState

UNITS = {"concentration": dim.DENSITY, "temperature": dim.TEMPERATURE, "number": dim.PLAIN}

LEAST_RATES = {1: 8.0, 2: 150.0}
"""By degree of elements: measured factor of D/cell^2 that is at most the fastest decay rate."""


WARM, COLD = 5.0, 150.0
"""[K] Numbers between which temperatures are most likely meant in °C: those below are as likely parts of a range."""
NUMBER = re.compile(r"[-+]?\d+\.?\d*")


def _names(what: str) -> tuple[str, ...]:
    """Names of the field among the outputs; a temperature keeps its former name `concentration` as well."""
    return ("temperature", "concentration") if what == "temperature" else ("concentration",)


class Diffusion(SpreadingMedium):
    """Diffusion dc/dt = div(D grad c) + source by finite volumes on cells, or by finite elements. Both conserve.

    A face between two cells carries D area (difference)/(distance); D there is the harmonic mean of the cells' where it
    depends on the place alone (layers in a row), else the arithmetic one. On a boundary the value, the flux, or both in
    proportion are given; where nothing is said nothing crosses. In formulas x, y, z, t and the field c are plain
    numbers in SI. A flat domain has x and y and a `depth`.

    With `method: elements` the field is that of Galerkin's weak form (Galerkin 1915) on triangles or tetrahedra, whose
    sides lie on the boundary; given values are held by Nitsche's terms (1971), and nothing carries it. Source:
    Patankar, Numerical Heat Transfer and Fluid Flow (1980), 4.2; Crank, The Mathematics of Diffusion (1975);
    Zienkiewicz & Taylor, The Finite Element Method (2000).
    """

    of: Literal["concentration", "temperature", "number"] = field(
        "What spreads, which gives its unit, and a temperature's output its name.", "concentration"
    )
    method: Literal["cells", "elements"] = field(
        "By finite volumes on cells, or by finite elements: triangles or tetrahedra with sides of a `cell`.", "cells"
    )
    element: Literal["p1", "p2"] | None = field(
        "The elements: p1, linear, of order 2; or p2, quadratic with sides curved onto the boundary, of order 3, the "
        "default.",
        None,
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
        by_elements = written.get("method") == "elements"
        text = "The field at every node of the elements." if by_elements else "The field in every cell of the domain."
        found = dict(gives_of(text, UNITS.get(what, dim.PLAIN), written))
        if by_elements:
            probes = written.get("probes")
            of_nodes = dict.fromkeys(map(str, probes if isinstance(probes, Mapping) else ()), "The value there.")
            for name, told in {"centers": "The places of these nodes.", **of_nodes}.items():
                found[name] = replace(found[name], doc=told, computed=True)
        own = found.pop("field")
        return {**dict.fromkeys(_names(what), own), **found}

    @classmethod
    def formula_dimension(cls, written: Mapping[str, Any]) -> Dimension | None:
        """That of what spreads."""
        return UNITS.get(str(written.get("of", "concentration")))

    def field_count(self) -> int:
        """One on cells."""
        return 1 if self.method == "cells" else 0

    def boundaries(self) -> Iterable[Boundary]:
        """That of its field."""
        return (self.boundary,)

    def coefficients(self) -> Iterable[tuple[Formula | None, tuple[str, ...]]]:
        """That of its field."""
        return ((self.coefficient, ("coefficient",)),)

    def doubts(self, clock: Clock) -> Iterable[Doubt]:
        """Temperatures without a unit that are most likely meant in °C."""
        start = self.initial if isinstance(self.initial, Formula) else None
        given = [one for one in (start, *(part.value for part in self.boundary.values())) if one is not None]
        known = [(number_in(one), one.span) for one in given]
        bare = [
            span for number, span in known if number is not None and span is not None and NUMBER.fullmatch(span.text)
        ]
        most = max((abs(number) for number, _ in known if number is not None), default=0.0)
        if self.of == "temperature" and given and len(bare) == len(given) and WARM < most < COLD:
            texts = list(dict.fromkeys(span.text for span in bare))
            text = f"a temperature without a unit is in K: {texts[-1]} K is {float(texts[-1]) - 273.15:.4g} °C"
            yield Doubt(
                "kelvin", text, bare[0], f"write `{'`, `'.join(f'{one} °C' for one in texts)}` if these are meant"
            )

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
        if self.method == "elements":
            d = number_in(self.coefficient)
            if d is not None:
                rate = LEAST_RATES[self.degree] * d / self.cell**2
                yield Oscillation(0.0, rate, f"the spread over elements of {self.cell:g} m", ("cell",))
            return
        found = self.spreading(self.coefficient, scene)
        if found is not None:
            yield found

    _solved: ElementField | None = PrivateAttr(None)

    def problems(self) -> Iterable[Problem]:
        """Besides those of any medium what elements cannot do, and an element of cells."""
        yield from super().problems()
        if self.method == "cells":
            if self.element is not None:
                yield Problem("cells have no `element`: say `method: elements`, too", ("element",), at_key=True)
            return
        if self.drift is not None:
            text = "elements carry nothing, they would swing: leave out `drift`, or `method: elements`"
            yield Problem(text, ("drift",), at_key=True)
        if "edges" in self.model_fields_set:
            yield Problem(
                "elements meet the boundary at their own sides: `edges` is for cells", ("edges",), at_key=True
            )
        for name, part in self.boundary.items():
            if part.open:
                yield Problem("`open` lets a drift through, and elements have none", ("boundary", name, "open"))

    @property
    def degree(self) -> int:
        """Of the functions of its elements."""
        return 1 if self.element == "p1" else 2

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve a number a cell or node and one for the inflow, and add the terms of the rate. Raises ScriptError."""
        self._solved = None
        if self.method == "elements":
            from sceneql.galerkin import assembly as elements

            self._solved = elements.add_field(self, self, self.boundary, self.degree, assembly)
            return
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

    def remark(self, state: ModelState) -> str:
        """Of elements how many, their worst angle, what bounds explicit steps, and what they do not keep."""
        return "" if self._solved is None else self._solved.remark(self.element or "p2")

    def connect(self, name: str, assembly: Assembly) -> None:
        """Add the drift by a flow that is solved. Raises ScriptError."""
        if self.drift is not None and self.drift.by is not None:
            from sceneql.flows.carried import carry

            grid = assembly.field_of(Link(name, _names(self.of)[0], Type((None,))))
            if grid is not None:
                carry(self, self.drift, [(grid, self.boundary)], assembly)

    def layout(self, state: ModelState, output: str = "concentration") -> FieldLayout:
        """Where its field lies, for pictures."""
        if self._solved is not None:
            return self._solved.layout
        return layout_of(state.ints[0], state.ints[1:], state.floats)

    def between(self, layout: FieldLayout, state: ModelState) -> Between:
        """What pictures of its field see between its values."""
        from sceneql.grids.maps.seen import between_cells

        return between_cells(layout, state) if self._solved is None else self._solved.between

    def by_methods(self) -> Mapping[str, Diffusion]:
        """Itself by every method, for `bench`; only itself where elements cannot do what it asks for."""
        given = {"method": "elements", "edges": "cut_cell"}
        if self.drift is not None or any(part.open for part in self.boundary.values()):
            return {"cells": self}
        cells = self.model_copy(update={"method": "cells", "element": None})
        return {"cells": cells, **{one: self.model_copy(update={**given, "element": one}) for one in ("p1", "p2")}}

    def spaced(self) -> float:
        """Side of its cells [m]."""
        return self.cell

    def resized(self, part: float) -> Diffusion:
        """Itself with cells of a part of their size."""
        return self.model_copy(update={"cell": part * self.cell})

    def along(self, name: str, state: ModelState) -> tuple[int, Any]:
        """How many unknowns its field has, and the function of places (k, 3) [m] that it is."""
        between = self.between(self.layout(state), state)
        held = between.filled(self.read(_names(self.of)[0], state))
        return between.count, lambda places: between.at(held, places)

    def samples(self, state: ModelState) -> tuple[Any, Any, Any]:
        """Places (k, 3) [m], the field there (k,), and the volumes (k,) [m^3] that these stand for."""
        if self._solved is not None:
            return self._solved.samples(state)
        layout = self.layout(state)
        volumes = state.floats[layout.volumes_at : layout.volumes_at + layout.count]
        return self.measure("centers", layout, state), self.measure("field", layout, state), volumes[volumes > 0.0]

    def shows(self, name: str) -> Value | None:
        """The field."""
        return Value(Link(name, _names(self.of)[0], Type((None,), UNITS[self.of])))

    def called(self, output: str) -> str:
        """Its field by what spreads."""
        return _names(self.of)[0] if output in _names(self.of) else output

    def read(self, output: str, state: ModelState) -> Any:
        """An output: (cells of the domain,), (cells, 3) or float."""
        what = "field" if output in _names(self.of) else output
        if self._solved is not None:
            return self._solved.measure(what, state)
        return self.measure(what, self.layout(state), state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the cells, of probes, and of what has come in."""
        what = "field" if output in _names(self.of) else output
        if self._solved is not None:
            return self._solved.places_of(what)
        return self.places_of(what, self.layout(state), state)
