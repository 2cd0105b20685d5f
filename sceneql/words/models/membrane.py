"""membrane: an elastic skin around fluid."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import PrivateAttr

from sceneql import kinds
from sceneql.kinds import Gives, Model, Problem, Quantity, Record, Ref, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Type
from sceneql.skins.elasticity import Elasticity, fastest

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Shape, Surface
    from sceneql.kinds import Moment
    from sceneql.skins.deep import Sheet
    from sceneql.skins.flat import Line
    from sceneql.system import Assembly, ModelState


class Springs(Record):
    """Springs along the sides of its triangles, or line: tension = prestress + stretch times the relative stretch."""

    stretch: kinds.FixedStiffness = field("How much its tension grows for a relative stretch.", above=0)


class NeoHookean(Record):
    """A thin sheet of rubber that keeps its own volume: energy G/2 (tr C + 1/det C - 3) a square meter at the start."""

    modulus: kinds.FixedStiffness = field("Its shear modulus G, times its thickness.", above=0)


class Skalak(Record):
    """The skin of a blood cell: energy G/4 (i^2 + 2 i - 2 k + A k^2) a square meter at the start.

    i = tr C - 2, k = det C - 1 (Skalak, Tozeren, Zarda & Chien 1973).
    """

    modulus: kinds.FixedStiffness = field("Its shear modulus G, times its thickness.", above=0)
    area: kinds.FixedScalar = field("A: how much it resists a change of its area.", "1", at_least=0)


class Law(Record):
    """How a skin pulls: one of these."""

    springs: Springs | None = field("Springs between its vertices.", None)
    neo_hookean: NeoHookean | None = field("A sheet of rubber.", None)
    skalak: Skalak | None = field("The skin of a blood cell.", None)
    tension: kinds.FixedStiffness | None = field("The same tension always, as that of a bubble.", None, above=0)

    def problems(self) -> Iterable[Problem]:
        """Several, or none."""
        if sum(one is not None for one in (self.springs, self.neo_hookean, self.skalak, self.tension)) != 1:
            yield Problem("a skin has one of `springs`, `neo_hookean`, `skalak` and `tension`")


class Filling(Record):
    """A fluid that a skin holds: other than that around it."""

    density: Annotated[float, Quantity(dim.DENSITY)] = field("Its density.", above=0)
    viscosity: Annotated[float, Quantity(dim.PRESSURE * dim.TIME)] = field("Its dynamic viscosity.", above=0)


class Membrane(Model):
    """A closed elastic skin without mass, full of fluid, that a `flow` carries and that pushes it (`immersion`).

    In a flat flow it is the outline of an object in the plane z = 0, in a deep one its surface in triangles, with
    vertices evenly apart that move as the fluid does. What it holds stays: the fluid is incompressible, and after each
    step one number moves all vertices along the slope of the volume, X += s dV/dX, so that what is drawn keeps it
    exactly; `volume_correction` sums what that put back. Stiff flat skins take long steps by `ark3`, which
    `auto` takes; deep ones, and those in flows with a `filling`, are explicit.

    With a `filling` it holds a fluid other than that of its flow: treacle in air, which `gravity` weighs. Masses in
    cells are what the drawn skin cuts off them, exactly; what crosses a side of a cell takes its momentum along.

    `models: {air: {flow: {size: 3 3 m, cell: 3/64 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s}}, balloon: {membrane: {of:
    egg, law: {springs: {stretch: 10 N/m}}, prestress: 2 N/m}}}`, `forces: [{immersion: {on: [balloon], in: air}}]`,
    `objects: {egg: {implicit: {field: "x^2/0.75^2 + y^2/0.5^2 - 1", position: 1.5 1.5 0 m}}}`.
    """

    has_bodies = False
    carried = True
    immersible = True

    of: kinds.ObjectRef = field("The object whose outline, or surface, it is.")
    law: Law = field("How it pulls: `{tension: 1 N/m}`, or `{springs: {stretch: 10 N/m}}`.")
    prestress: kinds.FixedStiffness = field("A tension that it has besides, always.", "0 N/m", at_least=0)
    bend: Annotated[float, Quantity(dim.ENERGY)] = field(
        "Its stiffness against bending: energy bend/2 (2 H)^2 a square meter, H its mean curvature.", "0 J", at_least=0
    )
    filling: Filling | None = field("What it holds; by default the fluid of its flow.", None)
    spacing: kinds.FixedLength | None = field(
        "How far its vertices are apart at the start; by default a quarter of a flat flow's cell, half a deep one's.",
        None,
        above=0,
    )
    volume: Literal["kept", "free"] = field("Whether what is drawn keeps its volume exactly.", "kept")
    thickness: kinds.FixedLength | None = field(
        "Of the line that draws a flat one; by default as `spacing`.", None, above=0
    )
    filled: bool = field("Whether what a flat one holds is drawn, too.", False)
    material: kinds.MaterialRef | None = field("How it looks where no object draws it.", None)
    color: kinds.Color | None = field("Color in place of the material's.", None)

    said_by: ClassVar = {
        "tension": "a law has it, `law: {tension: 1 N/m}`",
        **dict.fromkeys(("stiffness", "modulus"), "a law has it, `law: {springs: {stretch: 10 N/m}}`"),
        **dict.fromkeys(
            ("pressure", "volume_constraint"), "what it holds keeps its volume: pressure is what comes of it"
        ),
    }
    gives: ClassVar = {
        "positions": Gives(quantity_type(dim.LENGTH, (None, 3)), "Where its vertices are."),
        "volume": Gives(quantity_type(dim.VOLUME), "What it holds; of a flat one area times depth.", computed=True),
        "area": Gives(quantity_type(dim.AREA), "Its own; of a flat one length times depth.", computed=True),
        "center": Gives(quantity_type(dim.LENGTH, (3,)), "The center of what it holds.", computed=True),
        "deformation": Gives(
            Type(),
            "Taylor's (a - b)/(a + b) of the half axes of the ellipse with the same second moments.",
            computed=True,
        ),
        "pressure_jump": Gives(
            quantity_type(dim.PRESSURE),
            "The mean pressure of what it holds less that around it, three cells off the skin.",
            computed=True,
        ),
        "stretch": Gives(Type(), "The largest length of a side over that at the start.", computed=True),
        "potential": Gives(
            quantity_type(dim.ENERGY),
            "Energy of its tension, 0 at the start, and of its bending, 0 where it is flat.",
            computed=True,
        ),
        "volume_correction": Gives(
            quantity_type(dim.VOLUME), "The volume that was put back so far, in sum without signs.", tally=True
        ),
        "triangles": Gives(Type((None, 3)), "Of a deep one: its triangles by numbers of vertices.", computed=True),
        "count": Gives(Type(), "Number of vertices.", computed=True),
    }

    _made: Line | Sheet | None = PrivateAttr(None)

    def problems(self) -> Iterator[Problem]:
        """A prestress of a tension."""
        if self.law.tension is not None and self.prestress > 0.0:
            help = "leave out `prestress`, or write its tension into the law"
            yield Problem("a `tension` is all the tension that there is", ("prestress",), at_key=True, help=help)

    def insides(self) -> Iterable[Ref]:
        """The object."""
        return (self.of,)

    def standing(self) -> Iterable[Ref]:
        """The object: it is taken as it is at the start."""
        return (self.of,)

    def shown_in_place_of(self) -> Iterable[Ref]:
        """The object."""
        return (self.of,)

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve its vertices, add its tension and what keeps its volume. Raises ScriptError."""
        from sceneql.skins.fitting import must_fit, spacing_in

        flow = assembly.flow_of()
        if flow is None:  # a flow that could not be made has its own diagnostic
            return
        spacing = spacing_in(flow, self.spacing, self.of, assembly)
        law = self.elasticity()
        made: Line | Sheet
        largest = self.largest_tension(min(flow.spacing[: len(flow.areas)]))
        if len(flow.areas) == 2:
            from sceneql.skins.flat import add_line

            made = add_line(self.of, spacing, law, largest, self.volume == "kept", flow, assembly)
        else:
            from sceneql.skins.deep import add_sheet

            if self.filled or self.thickness is not None:
                what = "filled" if self.filled else "thickness"
                text = f"`{what}` is of a flat skin, which is a line; a deep one is drawn as its surface"
                raise ScriptError([Diagnostic("invalid", text, assembly.line(), f"leave `{what}` out")])

            made = add_sheet(self.of, spacing, law, largest, self.volume == "kept", flow, assembly)
        must_fit(made, self.of, assembly)
        assembly.membrane(made.membrane)
        self._made = made

    def elasticity(self) -> Elasticity:
        """Its elastic constants."""
        return Elasticity(
            self.law.tension or self.prestress,
            0.0 if self.law.springs is None else self.law.springs.stretch,
            0.0 if self.law.neo_hookean is None else self.law.neo_hookean.modulus,
            *((0.0, 0.0) if self.law.skalak is None else (self.law.skalak.modulus, self.law.skalak.area)),
            bend=self.bend,
        )

    def fluid(self) -> tuple[float, float] | None:
        """What it holds."""
        return None if self.filling is None else (self.filling.density, self.filling.viscosity)

    def connect(self, name: str, assembly: Assembly) -> None:
        """Tell its flow what it holds."""
        fluid, flow = self.fluid(), assembly.flow_of()
        if fluid is not None and flow is not None and self._made is not None:
            from sceneql.flows.varying.fluids import fill

            made = self._made
            fill(
                flow,
                made.membrane,
                made.triangles,
                fluid,
                self.largest_tension(min(flow.spacing[: len(flow.areas)])),
                assembly,
            )

    @property
    def made(self) -> Line | Sheet:
        """Its vertices and numbers in the run; there are none before the island is assembled."""
        assert self._made is not None
        return self._made

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual."""
        from sceneql.skins.skin_outputs import measure

        return measure(output, self.made, state)

    def trouble(self, state: ModelState) -> tuple[str, str]:
        """Vertices that have gone so far apart that fluid passes between them, and a skin that is inside out."""
        from sceneql.skins.skin_outputs import turned, widest

        inside_out = turned(self.made, state)
        if inside_out:
            help = "take a smaller `spacing` and `cell`, a `bend`, or a `collision`, which keeps it off itself"
            return inside_out, help
        apart = widest(self.made, state)
        text = f"the vertices of its skin are {apart:.2g} cells apart at the end: fluid passes between them"
        help = "take a smaller `spacing`, or a law that stretches less"
        return (text, help) if apart > 1.0 else ("", "")

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of its vertices."""
        import numpy as np

        skin = self.made.membrane
        rows = skin.position_at + np.arange(3 * skin.count).reshape(-1, 3)
        if output == "volume_correction":
            return np.array(skin.position_at + 3 * skin.count)
        return rows if output == "positions" else None

    def largest_tension(self, cell: float) -> float:
        """Times k^3/density, k one over the side of a flow's ``cell``, how fast its waves turn, squared [N/m].

        That of waves across it follows from its tension and its bending, of those along it from its stretch, all as the
        splines leave them (the eigenvalues of ellipses and bars in flows, tests/test_membranes.py).
        """
        return fastest(self.elasticity(), cell)

    def remark(self, state: ModelState) -> str:
        """Its vertices."""
        lengths = self.made.lengths
        return f"{self.made.membrane.count} vertices, {lengths.min():.3g} to {lengths.max():.3g} m apart"

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Shape]:
        """A closed line, filled where asked for."""
        yield from self.drawn(name, moment.surface(name, self.material, self.color), state, self.thickness)

    def drawn(
        self, name: str, surface: Surface, state: ModelState, thickness: float | None, place: Floats | None = None
    ) -> Iterable[Shape]:
        """A closed line of a thickness [m], mapped by ``place`` (3, 4)."""
        from sceneql.skins.drawn_skins import drawn

        return drawn(name, surface, self.made, thickness, self.filled, state, place)
