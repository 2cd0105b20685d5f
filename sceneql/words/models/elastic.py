"""elastic: solids of finite elements, with large deformations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import PrivateAttr

from sceneql import kinds
from sceneql.bodies import bodies as masses
from sceneql.bodies import solid_modes
from sceneql.bodies.elements import strain_outputs
from sceneql.bodies.elements.element import elements
from sceneql.bodies.elements.hold import Hold
from sceneql.bodies.elements.laws.law import AXES, MATERIAL, Laws, number
from sceneql.bodies.elements.load import Load, parts_on_lines
from sceneql.bodies.elements.named import SAID
from sceneql.bodies.elements.strain_outputs import OF_HOLD, OF_PROBE, OUTPUTS
from sceneql.bodies.filling.block import Block
from sceneql.bodies.filling.finer import Finer
from sceneql.bodies.solid_modes import Bent
from sceneql.galerkin.resized import Resized
from sceneql.kinds import Clock, Doubt, Formula, Gives, Model, Moment, Problem, Quantity, Ref, Symbols, TooCoarse, field
from sceneql.kinds.probed import HeldPart, Probed
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import suggestion

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.bodies.elements.element import Element
    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.bodies.elements.skin import Carried, Skin
    from sceneql.bodies.elements.strain import Strain
    from sceneql.bodies.solid_modes import Resting
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly, Bodies, ModelState

LOCKS = 0.4
"""Poisson's ratio above which elements have one mean dilatation by default."""
STIFF = 0.45
"""Poisson's ratio above which other elements lock so much that `check` warns."""
COARSEST = 2.0
"""Spacing, relative to the size of the filled object, above which no element fits into it."""
WATER = 1000.0
"""Default density [kg/m^3]."""
SOFT = 300
"""[Pa] Modulus below which 3 cm of the default density lie flat under their own weight."""


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """Solid as assembled for a run."""

    strain: Strain
    probes: Mapping[str, tuple[Any, Any]]
    """Nodes (k,) and weights (k,) of each probe."""
    forces: Mapping[str, int]
    """Offset of each hold's force [N] in the floats."""
    angles: tuple[float, float]
    """Least and largest angle [rad] between faces of an element."""
    skin: Callable[[], Skin | Carried]
    """Function that returns the surface to draw, made at the first call."""
    modes: Resting
    """State of rest whose modes are computed."""
    glued: Any
    """(n,) bool: nodes that holds without a motion keep in place."""


class Elastic(Resized, Model):
    """A solid of finite elements: density x'' = div P + forces, P the stress of its strain by its law (Cauchy 1827).

    It is an object filled with tetrahedra, a `block`, or of a `file`. Its nodes are masses, on which forces and
    contacts act. Places in `hold`, `loads`, `probes` and formulas are those of the material, before the solid is moved
    or turned.
    """

    gives: ClassVar[Mapping[str, Gives]] = {**masses.BODY_OUTPUTS, **OUTPUTS, **solid_modes.OUTPUTS}
    said_by: ClassVar[Mapping[str, str]] = SAID
    has_skin: ClassVar[bool] = True

    of: kinds.ObjectRef | None = field(
        "The object that it fills, which is seen and hit no more, unless other parts name it.", None
    )
    spacing: kinds.FixedLength | None = field(
        "Of an object: side of the cubes of the lattice that its tetrahedra are of; by default a tenth of its size, "
        "and a fifth for elements of ten nodes.",
        None,
        above=0,
    )
    block: Block | None = field("A brick in place of an object.", None)
    file: kinds.File | None = field(
        "In place of an object the tetrahedra of a .msh of Gmsh, saved as text of version 2 or 4; in meters.", None
    )
    finer: dict[str, Finer] = field(
        "Places near which its elements are smaller, by name; elements of a file have straight edges then.", {}
    )
    turn: kinds.FixedAngle = field(
        "Beside holes and in fillets of an object elements of ten nodes are so small that its surface turns no more "
        "along an edge of them, down to a quarter of the spacing.",
        "0.5 rad",
        above=0,
    )
    element: str | None = field(
        "Its elements, p1, p2 or p2_mean: of 4 or 10 nodes; the last, of one dilatation each, do not lock. By default "
        f"p2_mean above a Poisson ratio of {LOCKS}, else p2.",
        None,
    )
    law: Laws = field("How it resists strain: `{neo_hookean: {modulus: 10 kPa}}`.")
    density: Annotated[Formula, Symbols(AXES, dim.DENSITY, at_start=True)] | None = field(
        f"Its density, {MATERIAL}; by default {WATER:g} kg/m^3.", None
    )
    retardation: kinds.FixedTime = field(
        "Viscosity over elastic modulus (Kelvin & Voigt), of the rate of strain: rotation is free.", "0 s", at_least=0
    )
    mass_damping: kinds.FixedFrequency = field("Damping force over momentum.", "0 Hz", at_least=0)
    hold: dict[str, Hold] = field("Parts that are held, by name.", {})
    loads: dict[str, Load] = field("What acts on parts of its surface, by name.", {})
    probes: dict[str, kinds.FixedPosition] = field("Places of the material by name, which outputs tell of.", {})
    position: kinds.FixedPosition | None = field("Where its center of mass starts; by default where it is drawn.", None)
    rotation: kinds.Rotation | None = field("How it is turned at the start, about its center of mass.", None)
    velocity: kinds.FixedVelocity = field("Velocity at the start.", "0 0 0 m/s")
    spin: Annotated[tuple[float, float, float], Quantity(dim.FREQUENCY, (3,), turning=True)] = field(
        "Angular velocity at the start, about the center of mass [rad/s].", "0 0 0 rad/s"
    )
    modes: int = field("How many of its modes `frequencies` and `mode_shapes` tell, the lowest first.", 12, at_least=1)
    bent: Bent | None = field("One of its modes that it starts displaced by.", None)
    radius: kinds.FixedLength = field("Radius of its nodes in contacts.", "1 mm", at_least=0)
    look: Literal["object", "elements"] = field(
        "How it draws itself: as the object's own polygons, which its elements carry, or as the faces of these.",
        "object",
    )
    material: kinds.MaterialRef | None = field("How it looks where no object draws it.", None)
    color: kinds.Color | None = field("Color in place of the material's.", None)

    _made: Made | None = PrivateAttr(None)

    def problems(self) -> Iterator[Problem]:
        """Several of an object, a block and a file or none; elements that are none; names that two parts have."""
        given = [name for name in ("of", "block", "file") if getattr(self, name) is not None]
        if len(given) != 1:
            yield Problem("an elastic solid is either `of` an object, a `block` or of a `file`", tuple(given[1:2]))
        elif self.of is None and self.spacing is not None:
            text = "a block has `cells`, not a spacing" if self.block else "a file has its elements, and no spacing"
            yield Problem(text, ("spacing",), at_key=True)
        if self.element is not None and self.element not in elements():
            near = suggestion(self.element, elements())
            known = f"; {near}" if near else f"; there are {', '.join(elements())}"
            yield Problem(f"no element is called '{self.element}'{known}", ("element",), code="unknown-choice")
        for name, one in self.finer.items():
            if self.spacing is not None and one.spacing >= self.spacing:
                text = f"elements are no finer with {one.spacing:g} m than with the spacing of {self.spacing:g} m"
                yield Problem(text, ("finer", name, "spacing"))
        for name in self.probes:
            if name in self.hold:
                yield Problem(
                    f"'{name}' is the name of a hold, too: outputs could not tell them apart", ("probes", name)
                )
            if self.block is not None and not self.block.may_hold(self.probes[name]):
                yield Problem(f"the probe '{name}' stands outside of the block", ("probes", name), code="probe-outside")

    def doubts(self, clock: Clock) -> Iterator[Doubt]:
        """Elements that lock, and a modulus without a unit that is most likely meant in kPa."""
        modulus: Formula | None = getattr(self.law.law, "modulus", None)
        bare = "" if modulus is None or modulus.span is None else modulus.span.text
        if modulus is not None and self.density is None and bare.isdecimal() and 0 < int(bare) < SOFT:
            text = f"a modulus without a unit is in Pa: at {bare} Pa it lies flat under its own weight"
            yield Doubt("too-soft", text, modulus.span, f"write `{bare} kPa`, or another unit; jelly has some kPa")
        poisson = self.law.law.poisson
        if poisson is None or self.law.law.varies("poisson") or self.chosen_element().mean:
            return
        number = self.law.law.most_poisson()
        if number > STIFF:
            text = f"{self.element} is far too stiff at a Poisson ratio of {number:g}: it locks"
            yield Doubt("locking", text, poisson.span, "write `element: p2_mean`, which does not")

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all solids; `tip.position` of probes, `wall.force` of holds."""
        found = dict(cls.gives)
        for names, gives in ((written.get("probes"), OF_PROBE), (written.get("hold"), OF_HOLD)):
            for name in names if isinstance(names, Mapping) else ():
                found |= {f"{name}.{output}": one for output, one in gives.items()}
        return found

    def shown_in_place_of(self) -> Iterable[Ref]:
        """The object that it fills."""
        return () if self.of is None else (self.of,)

    def fillings(self) -> Iterable[tuple[Ref, Callable[[Floats, Floats], None]]]:
        """The object."""
        from sceneql.bodies.elements.filled import bounded_by

        if self.of is None or self.spacing is None:
            return
        spacing, bounds = self.spacing, bounded_by(self.spacing)

        def fits(low: Floats, high: Floats) -> None:
            bounds(low, high)
            if spacing > COARSEST * (size := float((high - low).max())):
                raise TooCoarse(f"the spacing is {spacing:g} m, and it is {size:.3g} m large; make that smaller")

        yield self.of, fits

    def probed(self) -> Iterable[Probed]:
        """Its probes, of an object."""
        if self.of is not None:
            for name, place in self.probes.items():
                yield Probed(("probes", name), place, self.of, self.spacing)

    def held_parts(self) -> Iterable[HeldPart]:
        """Its holds, of an object or a block."""
        place = self.block.box() if self.block is not None else self.of
        return (
            () if place is None else [HeldPart(name, one.place(), place, one.misses) for name, one in self.hold.items()]
        )

    def insides(self) -> Iterable[Ref]:
        """The object, and those that tell parts."""
        told = [part.object for part in (*self.hold.values(), *self.loads.values())]
        return [ref for ref in (self.of, *told) if ref is not None]

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """What its elements surpass in the small, where law and size are the same everywhere."""
        from sceneql.bodies.elements.filled import default_spacing

        element, spacing = self.chosen_element(), self.spacing
        if self.of is not None and spacing is None and (box := scene.box(self.of)) is not None:
            spacing = default_spacing(*box, element)
        size = spacing if self.block is None else self.block.finest
        wave, density = self.law.law.wave_modulus(), WATER if self.density is None else number(self.density)
        if wave and density and size:
            found = element.fastest[self.block is not None] * (wave / density) ** 0.5 / size
            decay, at = self.retardation * found**2 + self.mass_damping, ("spacing" if self.block is None else "block",)
            yield Oscillation(found, decay, f"the elements of '{name}', {size:.3g} m across", at)

    @property
    def solid(self) -> Strain:
        """Its elements in the run; there are none before the island is assembled."""
        assert self._made is not None
        return self._made.strain

    @property
    def skin(self) -> Skin | Carried:
        """What it is drawn by: the polygons of its object, or its outer faces."""
        assert self._made is not None
        return self._made.skin()

    def chosen_element(self) -> type[Element]:
        """The element that the script names, or that suits its law."""
        if self.element is not None:
            return elements()[self.element]
        return elements()["p2_mean" if self.law.law.most_poisson() > LOCKS else "p2"]

    def mesh(self, assembly: Assembly) -> ElementMesh:
        """Its mesh. Raises ScriptError for an object that cannot be filled, LimitRefused for too many elements."""
        from sceneql.bodies.elements.filled import filled, laid, of_file

        element, parts = self.chosen_element(), parts_on_lines(self.hold, self.loads)
        if self.block is not None:
            return laid(self.block, element, self.finer, assembly, parts)
        if self.file is not None:
            return of_file(self.file, element, self.finer, assembly, parts)
        assert self.of is not None
        return filled(self.of, self.spacing, element, self.finer, assembly, self.turn if element.edges else None, parts)

    def assemble(self, name: str, assembly: Assembly) -> Bodies:
        """Reserve the nodes as masses; add the forces of strain, of loads, of damping, and what holds it."""
        import numpy as np

        from sceneql.bodies.elements import hold as holding
        from sceneql.bodies.elements import skin as skins
        from sceneql.bodies.elements.element_mesh import worst_angle
        from sceneql.bodies.elements.strain import Inertia, add_mass_damping, add_strain, density_of
        from sceneql.bodies.elements.strain_outputs import probe
        from sceneql.bodies.filling.tetrahedra import edges
        from sceneql.shapes.placement import rotation_matrix
        from sceneql.system import Skin, Springs

        mesh, line = self.mesh(assembly), assembly.line()
        inertia, count = Inertia.of(mesh, density_of(self.density, WATER)), len(mesh.points)
        center = np.average(mesh.points, axis=0, weights=inertia.sums)
        arms = mesh.points - center
        if self.rotation is not None:
            arms = arms @ rotation_matrix(assembly.initial(self.rotation)).T
        places = arms + (center if self.position is None else np.asarray(self.position))
        velocities = np.asarray(self.velocity) + np.cross(self.spin, arms)
        if self.rotation is None and self.position is None:
            places = mesh.points
        held: Any = np.zeros((count, 3), dtype=bool)
        nodes, whole, glued = {}, np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        for called, hold in self.hold.items():
            some = holding.chosen(called, hold, mesh, assembly, line)
            some = nodes[called] = some[~held[some][:, hold.axes()].any(axis=1)]
            held[np.ix_(some, hold.axes())] = True
            whole[some] |= len(hold.axes()) == len(AXES)
            glued[some] |= len(hold.axes()) == len(AXES) and hold.still(assembly)
            led = holding.start_velocity(hold, places[some], assembly)
            velocities[np.ix_(some, hold.axes())] = led[..., hold.axes()]
        matrix = inertia.freed(held) if inertia.consistent else None
        radii = np.full(count, self.radius)
        bodies = masses.reserve(name, assembly, places, velocities, inertia.lumped, radii, whole, inertia=matrix)
        assembly.write(bodies.mass_at, inertia.sums)
        strain = add_strain(assembly, bodies, mesh, places, self.law.law, self.retardation, held, inertia)
        for called, load in self.loads.items():
            load.assemble(called, mesh, held, assembly, bodies, line)
        if self.mass_damping > 0.0:
            add_mass_damping(assembly, bodies, self.mass_damping, inertia.matrix)
        parts = {}
        for called, some in nodes.items():
            rows = inertia.matrix[some]
            weights = np.asarray(rows.sum(axis=0)).ravel()
            near = np.flatnonzero(weights)
            parts[called] = holding.Held(some, places[some], near, weights[near], ~held[near], rows)
        forces = holding.add_holds(self.hold, parts, assembly, bodies)
        probes = {called: probe(called, mesh, np.asarray(place), line) for called, place in self.probes.items()}
        angles = worst_angle(mesh.points, mesh.cells[:, :4])
        drawn: Any = cache(partial(skins.Skin.of, mesh))
        if self.of is not None and self.look == "object":
            from sceneql.bodies.elements.filled import spacing_of

            spacing = spacing_of(self.of, self.spacing, self.chosen_element(), assembly)
            drawn = cache(partial(skins.carried, self.of, spacing, mesh, assembly))
        resting = solid_modes.Resting(strain, places, held)
        if self.bent is not None:
            away = resting.modes(assembly.numbers(), max(self.bent.mode, self.modes)).start(self.bent, line)
            assembly.displaced(bodies.position_at, (places + away).ravel())
        self._made = Made(strain, probes, forces, angles, drawn, resting, glued)
        period = 2.0 * np.pi / strain.squared**0.5
        first, shear = (np.asarray(one) for one in self.law.law.moduli(mesh.points))
        stiffness = float(np.min(shear * (3.0 * first + 2.0 * shear) / (first + shear)))
        skin = Skin(skins.triangles(mesh), held, stiffness)
        ends = edges(mesh.cells[:, :4])[0]
        return replace(bodies, springs=Springs(ends, np.zeros((2, len(ends))), period), skin=skin)

    def remark(self, state: ModelState) -> str:
        """Its elements, their worst angle, the one that bounds steps, and what its law cannot do."""
        import numpy as np

        from sceneql.bodies.elements.element_mesh import worst_angle

        assert self._made is not None
        mesh, (least, largest) = self.solid.mesh, self._made.angles
        called = next(name for name, one in elements().items() if one is mesh.element)
        told = f"{len(mesh.cells)} elements {called} of {len(mesh.points)} nodes"
        told += f", angles between faces {np.degrees(least):.0f} to {np.degrees(largest):.0f} degrees{mesh.told()}"
        told += f"; no oscillation is faster than {self.solid.squared**0.5 / (2 * np.pi):.4g} Hz in the small"
        corners = mesh.points[mesh.cells[[self.solid.stiffest], :4]]
        sharpest, _ = worst_angle(corners[0], np.arange(4, dtype=np.int32)[None])
        where = ", ".join(f"{c:.3g}" for c in corners[0].mean(axis=0))
        told += f", which an element at ({where}) m sets, with an angle of {np.degrees(sharpest):.0f} degrees"
        if self.solid.inertia.consistent:
            told += "; its mass is a matrix, with which explicit methods solve at each rate"
        return f"{told}{self.law.law.warning()}"

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual, those of probes and of holds."""
        assert self._made is not None
        assert state.bodies is not None
        if output in strain_outputs.BY_INERTIA:
            return strain_outputs.by_inertia(output, self.solid, state)
        if output in solid_modes.OUTPUTS:
            return self._made.modes.modes(state.floats, self.modes).read(output)
        if output in masses.BODY_OUTPUTS:
            own = self.solid.energy(state) if output == "potential" else 0.0
            if output == "energy":
                return sum(self.read(part, state) for part in ("kinetic", "potential", "dissipated"))
            return masses.read(output, state.bodies, state, own)
        if output in OUTPUTS:
            return strain_outputs.read(output, self.solid, state)
        name, _, what = output.rpartition(".")
        if name in self._made.forces:
            at = self._made.forces[name]
            return state.floats[at : at + 3].copy()
        return strain_outputs.read_probe(what, *self._made.probes[name], self.solid, state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the nodes."""
        assert state.bodies is not None
        return masses.places(output, state.bodies)

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Shape]:
        """Its outer faces, or the polygons of its object; and dark plates on the faces that are held still."""
        from sceneql.bodies.elements import skin
        from sceneql.bodies.spring_look import plates

        assert self._made is not None
        surface, places = moment.surface(name, self.material, self.color), self.read("positions", state)
        yield self.skin.drawn(name, surface, places)
        yield from plates(name, places, self._made.glued, skin.triangles(self.solid.mesh))
