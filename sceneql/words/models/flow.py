"""flow: an incompressible fluid in a box."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import PrivateAttr

from sceneql import kinds
from sceneql.flows.parts import (
    FORCE,
    MOST_FACTORED,
    VISCOSITY,
    Buoyancy,
    Side,
    Start,
    comes_in,
    fastest_solid,
    fastest_turn,
    of_field,
    thickest,
)
from sceneql.grids.domain.cells import MOST_CELLS, SIDES, counts, too_far
from sceneql.grids.medium import SHORTEST, SIZES, FieldLayout, layout_of, number_in, spacing_of
from sceneql.grids.multigrid.linear_solvers import Linear
from sceneql.grids.probing import misnamed, outside
from sceneql.kinds import Formula, Gives, Model, Problem, Quantity, Value, field, quantity_type
from sceneql.kinds.probed import Probed
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import suggestion
from sceneql.quantities.expression import Link, Type

if TYPE_CHECKING:
    from sceneql.grids.domain.cells import Cells
    from sceneql.system import Assembly, ModelState

THICKEST = 1e100
"""Largest viscosity [Pa s]: its products with lengths do not overflow."""
MOST_LAID_OUT = {2: 300_000, 3: 60_000}
"""Most cells of a 2D or 3D flow that `check` lays out."""
FIELDS = ("speed", "vorticity", "pressure")
AT_ONCE = ("auto", "fast_transform", "direct")
"""Solvers of the pressure without a history of residuals."""


class Flow(Model):
    """Incompressible flow, du/dt + div(u u) = -grad p/density + viscosity/density lap u + forces, div u = 0, in a box.

    Velocities stand at the faces of cells, the pressure at their centers; each rate loses its divergence by a
    projection, so explicit solvers run as they are. Where nothing is said of a side it is a wall that the fluid sticks
    to. Advection by `koren` is limited and of order 3 where the flow is smooth, `central` keeps the energy, `upwind` is
    of order 1. In formulas x, y, z and t are plain numbers in SI. A flat flow has x and y and a `depth`. Sources:
    Harlow & Welch (1965), Phys. Fluids 8, 2182-2189; Chorin (1968), Math. Comp. 22, 745-762; Koren (1993).

    One density would add the pressure of its weight and no motion: the scene's `gravity` and other forces leave a flow
    alone. `force: "[0, -9.81*1000]"` has that pressure; `buoyancy` has warm fluid rise. What skins hold (`filling` of
    `membrane`) weighs what it is heavier than the fluid around it, whose own pressure is left out. A `viscosity` that
    varies gives the stress mu (grad u + grad u^T); fields that such a flow carries spread explicitly. Several fluids,
    and such a viscosity, go past solids that stand, with an error of order 1 in their cells; the force on these is then
    not known.

    A lid that moves along a square: `air: {flow: {size: 1 1 m, cell: 2 cm, density: 1 kg/m^3, viscosity: 0.01 Pa*s,
    boundary: {top: {wall: {velocity: "[1, 0]"}}}}}`, seen by `{field_map: {of: air.speed}}` and `{streamlines: {of:
    air.velocity}}`; a `diffusion` in the same box with `drift: {by: air}` is carried by it. Solvers for flows are
    `ark3` (that of `auto`), `sbdf2`, `cnab2` and `chorin`, of several fluids or with a viscosity that varies
    `imex_midpoint` (that of `auto`) and `chorin`; explicit ones bear viscosity up to the step that `check`
    tells.
    """

    has_bodies = False
    flows = True
    swinging: ClassVar[tuple[str, ...]] = ("vorticity",)
    """Fields among its outputs that are of both signs."""

    said_by: ClassVar = {
        "reynolds": "it is density times speed times length over viscosity: `viscosity: 1 kg/m^3*1 m/s*1 m/100`"
    } | dict.fromkeys(
        ("inlet", "outlet", "inflow", "outflow", "walls", "wall", "sides", "boundaries"),
        'sides are told by `boundary: {left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}`; others are walls',
    )

    size: SIZES | None = field("Sides of the box: two for a flat one, three for a deep one.", None, above=0)
    domain: kinds.ObjectRef | None = field(
        "In place of `size` the object whose inside it fills, cut out of the box around it: its skin is a wall, but "
        "at sides of that box which `boundary` names: there its section three cells off is drawn straight on.",
        None,
    )
    flat: bool = field("The section of that object at z = 0 alone.", False)
    corner: SIZES | None = field("Low corner of the box; by default the origin.", None)
    depth: kinds.FixedLength = field("How thick a flat box is.", "1 m", above=0)
    cell: kinds.FixedLength = field("Largest side of a cell.", above=0)
    density: Annotated[float, Quantity(dim.DENSITY)] = field("The density.", above=0)
    viscosity: VISCOSITY = field(
        "The dynamic viscosity, a number or by place and time: `1e-3*(1 + x)`; or by a field that it carries, which is "
        "`c` there, a plain number in SI: `0.1*exp(-0.05*(c - 20))`."
    )
    viscosity_by: Annotated[Value, Quantity(None, (None,))] | None = field(
        "The field that is `c` in `viscosity`, in the same domain: `heat.temperature`.", None
    )
    initial: Start | None = field("The flow at the start; by default at rest.", None)
    boundary: dict[str, Side] = field(
        "What holds on the sides `left`, `right` (x), `bottom`, `top` (y), `back`, `front` (z), on any part `where` a "
        "formula holds or `near` a place, or on `rest`: a `wall`, an `inflow`, an `outflow`, or `periodic`. Named like "
        "a solid, a `wall` with the velocity of its skin: `{drum: {wall: {velocity: [-y, x]}}}` turns it in place.",
        {},
    )
    around: tuple[kinds.ObjectRef, ...] = field(
        "Solids in the flow, which may move by keys or formulas; a flow `air` around `cyl` gives `air.cyl.force` and "
        "`air.cyl.torque`.",
        (),
    )
    edges: Literal["cut_cell", "staircase"] = field(
        "How cells meet these solids: cut by them, or whole where their centers lie outside.", "cut_cell"
    )
    advection: Literal["koren", "central", "upwind"] = field("How velocities are carried.", "koren")
    pressure: Linear = field(
        "How its equation is solved: `auto` by fast transforms, in a box alone, or else with these as preconditioner; "
        "the others compare, and give the output `residuals`.",
        "auto",
    )
    probes: dict[str, SIZES] = field(
        "Places by name: `behind: 0.7 0.5 m` in a flow `air` gives `air.behind.velocity` and `air.behind.pressure`.", {}
    )
    force: FORCE | None = field("A force on each cubic meter, by place and time: a component for each side.", None)
    buoyancy: Buoyancy | None = field("What a temperature or concentration does to it.", None)

    gives = {  # noqa: RUF012
        "velocity": Gives(
            quantity_type(dim.VELOCITY, (None, 3)), "The velocity at the centers of cells.", computed=True
        ),
        "speed": Gives(quantity_type(dim.VELOCITY, (None,)), "Its size.", computed=True),
        "vorticity": Gives(
            quantity_type(dim.FREQUENCY, (None,)), "Its curl: along z in a flat flow, else its size.", computed=True
        ),
        "pressure": Gives(
            quantity_type(dim.PRESSURE, (None,)), "The pressure; in a closed box its mean is 0.", computed=True
        ),
        "centers": Gives(quantity_type(dim.LENGTH, (None, 3)), "The centers of the cells.", computed=True),
        "kinetic_energy": Gives(quantity_type(dim.ENERGY), "The kinetic energy.", computed=True),
        "momentum": Gives(quantity_type(dim.MASS * dim.VELOCITY, (3,)), "The momentum.", computed=True),
        "divergence": Gives(
            quantity_type(dim.FREQUENCY), "The largest divergence that the projection leaves.", computed=True
        ),
        "largest_speed": Gives(quantity_type(dim.VELOCITY), "The largest speed.", computed=True),
    }

    _masses_at: int = PrivateAttr(-1)
    """Offset of the masses in the faces' own cells, for several fluids; else -1."""

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of the flow, and of each solid."""
        around = written.get("around", ())
        listed = [around] if isinstance(around, str) else around
        names = [*listed] if isinstance(listed, list | tuple) else []
        names += [written["domain"]] if written.get("domain") is not None else []
        found = dict(cls.gives)
        if written.get("pressure", "auto") not in AT_ONCE:
            rate = quantity_type(dim.VOLUME * dim.FREQUENCY, (None,))
            text = (
                "What the latest solution for the pressure left, by iterations: of `gauss_seidel`, `sor` every fourth."
            )
            found["residuals"] = Gives(rate, text, computed=True)
        for name in names:
            found[f"{name}.force"] = Gives(quantity_type(dim.FORCE, (3,)), "What the fluid does to it.", computed=True)
            found[f"{name}.torque"] = Gives(
                quantity_type(dim.FORCE * dim.LENGTH, (3,)), "Its torque about the origin.", computed=True
            )
        probes = written.get("probes")
        for name in map(str, probes if isinstance(probes, Mapping) else ()):
            found[f"{name}.velocity"] = Gives(quantity_type(dim.VELOCITY, (3,)), "The velocity there.", computed=True)
            found[f"{name}.pressure"] = Gives(quantity_type(dim.PRESSURE), "The pressure there.", computed=True)
        return found

    @property
    def skins(self) -> tuple[kinds.Ref, ...]:
        """The solids, and last the object that it fills."""
        return (*self.around, *(() if self.domain is None else (self.domain,)))

    def insides(self) -> Iterable[kinds.Ref]:
        """The solids, and what it fills."""
        return self.skins

    def probed(self) -> Iterable[Probed]:
        """Probes in what it fills."""
        if self.domain is not None:
            for name, place in self.probes.items():
                yield Probed(("probes", name), place, self.domain, self.cell)

    def shaped(self) -> Iterable[kinds.Ref]:
        """The same: cells are cut by them, wherever they move."""
        return self.skins

    def shown_in_place_of(self) -> Iterable[kinds.Ref]:
        """What it fills."""
        return () if self.domain is None else (self.domain,)

    def problems(self) -> Iterable[Problem]:
        """Sides that do not fit, too many cells, boundaries of no side."""
        viscosity = number_in(self.viscosity)
        if viscosity is not None and not 0.0 <= viscosity <= THICKEST:
            ends = f"at least 0 and at most {THICKEST:g}"
            yield Problem(f"viscosity must be {ends}, and is {viscosity:g}", ("viscosity",), code="out-of-range")
        yield from self._thickened()
        if (self.size is None) == (self.domain is None):
            yield Problem("a flow fills one of `domain` and `size`")
            return
        if self.corner is not None and self.size is None:
            yield Problem("the box of a `domain` is the one around it, and has no `corner`", ("corner",), at_key=True)
        if self.flat and self.size is not None:
            yield Problem("`flat` is for a `domain`: a box is flat where it has two sides", ("flat",), at_key=True)
        yield from self._named()
        yield from misnamed(self.probes, [*self.gives, *(ref.name for ref in self.skins)])
        if self.size is None:
            return
        if len(self.size) not in (2, 3) or (self.corner is not None and len(self.corner) != len(self.size)):
            yield Problem("a box has two or three sides, and its corner as many numbers")
            return
        if self.cell < SHORTEST or min(self.size) < SHORTEST:
            yield Problem(f"a cell is at least {SHORTEST:g} m", ("cell",), code="out-of-range")
            return
        if self.corner is not None and (wrong := too_far(self.corner, self.cell)):
            yield Problem(wrong, ("corner",), code="out-of-range")
        yield from outside(self.probes, self.corner or (0.0,) * len(self.size), self.size)
        shape = counts(self.size, self.cell)
        cells = shape[0] * shape[1] * shape[2]
        if cells > MOST_CELLS:
            text = f"{cells:.3g} cells: at most {MOST_CELLS:,} are possible; take a larger `cell`"
            yield Problem(text, ("cell",), code="limit-refused")
        if min(shape[: len(self.size)]) < 2:
            yield Problem("a flow has two cells or more along each side", ("cell",))
        most = MOST_FACTORED[len(self.size)]
        if self.pressure == "direct" and most < cells <= MOST_CELLS:
            text = f"factors of {cells:,} cells would not fit: at most {most:,} in {len(self.size)} dimensions"
            yield Problem(f"{text}; take `multigrid`", ("pressure",), code="limit-refused")

        yield from self._balanced(len(self.size))

    def _thickened(self) -> Iterable[Problem]:
        """Problems: a field that viscosity does not read, or one that it reads and the script does not name."""
        by = self.viscosity_by
        if by is None and of_field(self.viscosity):
            yield Problem(
                "`c` in the viscosity is a field: say which by `viscosity_by: heat.temperature`", ("viscosity",)
            )
        elif by is not None and not isinstance(by.expr, Link):
            yield Problem("this is the field of a model itself: `heat.temperature`", ("viscosity_by",))
        elif by is not None and not of_field(self.viscosity):
            text = "`viscosity` does not read this field: it is `c` there, as in `0.1*exp(-0.05*(c - 20))`"
            yield Problem(text, ("viscosity_by",), at_key=True)

    def _balanced(self, sides: int) -> Iterable[Problem]:
        """Problems: velocities with a wrong number of components; fluid that enters and cannot leave."""
        given: dict[str, Formula | None] = {name: part.velocity for name, part in self.boundary.items()}
        wrong = [name for name, one in given.items() if one is not None and one.expr.type.shape not in ((), (sides,))]
        for name in wrong:
            path = ("boundary", name, "wall" if self.boundary[name].inflow is None else "inflow", "velocity")
            example = ", ".join(["1", *["0"] * (sides - 1)])
            text = f"this velocity needs {sides} components, one for each side of the box"
            yield Problem(text, path, code="wrong-shape", help=f"write `[{example}]`, or formulas in their places")
        if not wrong and self.size is not None and (more := comes_in(self.boundary, self.size)):
            text = f"{abs(more):.3g} m^3/s more come {'in' if more > 0 else 'out'} than "
            text += f"{'out' if more > 0 else 'in'}, and the flow cannot be compressed"
            help = "give a part of the boundary `outflow: {}`"
            yield Problem(text, ("boundary",), code="no-way-out", help=help)

    def _named(self) -> Iterable[Problem]:
        """Problems: boundary parts that do not fit, and a solver that does not support solids."""
        if self.pressure == "fast_transform" and self.skins:
            yield Problem("a fast transform needs a box without solids: take `auto`", ("pressure",))
        solids = {ref.name for ref in self.skins}
        for name, part in self.boundary.items():
            if name in solids and (part.wall is None or part.velocity is None or part.chosen or part.slip > 0.0):
                text = f"of the solid '{name}' a flow takes a whole `wall` with a `velocity`, which fluid sticks to"
                yield Problem(text, ("boundary", name), at_key=True)
        sides = SIDES if self.size is None else SIDES[: 2 * len(self.size)]
        known = (*sides, "rest", *solids)
        for name in [name for name, part in self.boundary.items() if name not in known and not part.chosen]:
            text = f"the boundary has no side '{name}': it has {', '.join(known)}; or say `where` or `near`"
            yield Problem(text, ("boundary", name), at_key=True, help=suggestion(name, known))

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """What limits explicit steps: viscosity, by at most 4 nu sum of 1/spacing^2 (von Neumann), and advection."""
        spacing = spacing_of(self, scene)
        decay = 4.0 * self.thickest() / self.density * sum(1.0 / side**2 for side in spacing)
        if decay > 0.0:
            yield Oscillation(0.0, decay, f"the viscosity over cells of {self.cell:g} m", ("viscosity",))
        moved, mover = fastest_solid(self.around, scene, spacing)
        if moved > 0.0:
            what = f"the solid '{mover}' that moves through cells of {self.cell:g} m"
            yield Oscillation(0.0, 0.5 * decay, what, ("cell",), moved, later=True)
        if self.size is None:
            return
        turn = fastest_turn(self.initial, self.boundary, self.corner or (0.0,) * len(self.size), self.size, spacing)
        if turn > 0.0:  # advection is fastest for waves of four cells, at which viscosity has half its largest rate
            yield Oscillation(0.0, 0.5 * decay, f"the flow through cells of {self.cell:g} m", ("cell",), turn)

    def thickest(self) -> float:
        """The viscosity [Pa s], of a formula the largest by samples of the start."""
        low = self.corner or (0.0,) * len(self.size or ())
        return thickest(self.viscosity, low, self.size or ())

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve a number a face, and add the terms of the rate. Raises ScriptError."""
        from sceneql.flows.assembly import add_flow
        from sceneql.flows.varying.fluid_layout import MASSES
        from sceneql.grids.ground import Ground

        ground = Ground(self.box(assembly), assembly)
        flow = add_flow(name, self, ground.cells, assembly)
        self._masses_at = flow.varying[MASSES] if flow.varying else -1
        assembly.remember(*ground.memory, *flow.ints)

    def box(self, assembly: Assembly) -> Cells:
        """Its cells. Raises ScriptError, LimitRefused."""
        from sceneql.flows.fluid_box import box_of

        size = self.size or ()
        corner = self.corner or (0.0,) * len(size)
        return box_of(self.domain, self.flat, size, corner, self.cell, self.depth, self.boundary, assembly)

    def connect(self, name: str, assembly: Assembly) -> None:
        """Add what fields do to it. Raises ScriptError where one is of another domain."""
        if self.buoyancy is not None:
            from sceneql.flows.carried import add_buoyancy

            add_buoyancy(self.buoyancy, name, assembly)
        if self.viscosity_by is not None:
            from sceneql.flows.varying.thickness import thicken

            thicken(self.viscosity_by, self.viscosity, name, assembly)

    def trouble(self, state: ModelState) -> tuple[str, str]:
        """Solids that go through the sides of a closed box."""
        from sceneql.flows.readings import crowded

        if not crowded(state.ints[5:], state.floats):
            return "", ""
        text = "a solid moves through a side of a closed box, and the flow cannot be compressed"
        return text, "give a part of the boundary `outflow: {}`, or keep the solid inside"

    def layout(self, state: ModelState, output: str) -> FieldLayout:
        """Where the values at centers lie, for pictures."""
        return layout_of(0, state.ints[:5], state.floats)

    def told_by_layout(self) -> bool:
        """Unless it has very many cells: how solids cut them, and what flows in and out, shows then."""
        if self.size is None:
            return True
        shape = counts(self.size, self.cell)
        return bool(shape[0] * shape[1] * shape[2] <= MOST_LAID_OUT[len(self.size)])

    def shows(self, name: str) -> Value | None:
        """Its speed."""
        return Value(Link(name, "speed", Type((None,), dim.VELOCITY)))

    def drawn_by(self, name: str) -> tuple[str, Value] | None:
        """A deep flow by its streamlines: a map on its box would show its walls alone, and hide what is inside."""
        if self.flat if self.size is None else len(self.size) == 2:
            return super().drawn_by(name)
        return "streamlines", Value(Link(name, "velocity", Type((None, 3), dim.VELOCITY)))

    def read(self, output: str, state: ModelState) -> Any:
        """An output: (cells,), (cells, 3), (3,) or float."""
        from sceneql.flows.readings import at_place, measure

        name, _, what = output.rpartition(".")
        if name in self.probes:
            place = self.probes[name]
            return at_place(what, place, self.layout(state, output), state.ints[5:], self.density, state)
        if name:
            from sceneql.flows.obstacles.solid_forces import on_solid

            if self._masses_at >= 0:
                raise ValueError(f"the {what} on a solid is not known in a flow whose density or viscosity varies")
            number = [ref.name for ref in self.skins].index(name)
            return on_solid(what, number, self.layout(state, output), state.ints[5:], self.density, state)
        return measure(output, self.layout(state, output), state.ints[5:], self.density, state, self._masses_at)
