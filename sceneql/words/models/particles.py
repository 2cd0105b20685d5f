"""particles: point masses that feel forces and contacts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import field_validator

from sceneql import kinds
from sceneql.bodies import bodies as masses
from sceneql.bodies.emitter import Aging, Emit
from sceneql.bodies.filling.fill import Fill, filled
from sceneql.island.memory import bounded
from sceneql.kinds import Clock, Doubt, Gives, Model, Moment, Problem, Record, Ref, Value, field, quantity_type
from sceneql.kinds.stable_step import StaticMass
from sceneql.quantities import dimension as dim
from sceneql.shapes.color import default_color, linear

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.frame import Points as Spheres
    from sceneql.system import Assembly, Bodies, ModelState

SOURCES = ("list", "of", "positions", "fill", "emit")


class Particle(Record):
    """One named particle."""

    mass: kinds.FixedMass = field("Its mass.", "1 kg", above=0)
    position: kinds.FixedPosition = field("Where it starts.", "0 0 0 m")
    velocity: kinds.FixedVelocity = field("How fast it starts.", "0 0 0 m/s")
    radius: kinds.FixedLength | None = field(
        "Its radius in contacts and in the picture; by default the model's.", None, at_least=0
    )
    fixed: bool = field("It never moves.", False)
    color: kinds.Color | None = field(
        "Its color; by default the model's, or one of its own if nothing has a color.", None
    )

    def problems(self) -> Iterator[Problem]:
        """A particle that is held and moves."""
        if self.fixed and any(self.velocity):
            yield Problem("a fixed particle has no velocity", ("velocity",))


class Particles(Model):
    """Point masses: m a = F (Newton 1687), where F is what the scene's forces and contacts do to them.

    They are listed by name (``list``), or come from an object that they then drive (``of``: its place at the start and
    its radius are read from it), from points (``positions``), from an object that they fill (``fill``), or are born and
    die (``emit``); but for the listed ones all have the same mass. What is not yet born or has died feels and does
    nothing, is not drawn, and is in no output; births bring energy and deaths take it.

    For example `drop: {particles: {of: ball, mass: 1 kg}}`.
    """

    inert: ClassVar[bool] = True
    gives: ClassVar[Mapping[str, Gives]] = {
        **masses.BODY_OUTPUTS,
        "ages": Gives(quantity_type(dim.TIME, (None,)), "Time since each was born, or since the start.", computed=True),
    }

    list: dict[str, Particle] | None = field("Particles by name.", None)
    of: kinds.ObjectRef | None = field("The object that is the particle, and that it drives.", None)
    positions: kinds.Points | None = field("Where particles start, when they need no names; `{file: cloud.csv}`.", None)
    fill: Fill | None = field("An object that they fill at the start.", None)
    emit: Emit | None = field("A source from which they come.", None)
    mass: kinds.FixedMass = field("Mass of each that is not listed.", "1 kg", above=0)
    velocity: kinds.FixedVelocity = field("Velocity at the start, but for listed and emitted ones.", "0 0 0 m/s")
    radius: kinds.FixedLength | None = field(
        "Radius in contacts and in the picture; by default the object's (a box: half its least side), else 0.05 m.",
        None,
        at_least=0,
    )
    aging: Aging | None = field("How emitted ones change with their age.", None)
    material: kinds.MaterialRef | None = field("How they look where no object draws them.", None)
    color: kinds.Color | None = field("Color in place of the material's.", None)

    @field_validator("fill")
    @classmethod
    def _can_be_held(cls, fill: Fill | None) -> Fill | None:
        bounded(fill.count or 0 if fill is not None else 0)
        return fill

    def lasts(self) -> bool:
        """Emitted ones come and go."""
        return self.emit is None

    def problems(self) -> Iterator[Problem]:
        """Several sources or none, an empty one, and ages of what is never born."""
        given = [name for name in SOURCES if getattr(self, name) is not None]
        if len(given) != 1:
            text = "particles come from one of `list`, `of`, `positions`, `fill` and `emit`"
            said = f", not from {' and '.join(given)}" if given else ""
            yield Problem(text + said, tuple(given[1:2]), at_key=True)
        if self.list is not None and not self.list:
            yield Problem("the list of particles is empty", ("list",))
        if self.aging is not None and self.emit is None:
            yield Problem("only particles that are emitted have an age", ("aging",), at_key=True)

    def doubts(self, clock: Clock) -> Iterable[Doubt]:
        """Those of births."""
        return () if self.emit is None else self.emit.doubts(clock)

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all masses; named ones add ``name.position`` and so on, one `of` an object adds ``position``."""
        single = masses.MASS_OUTPUTS if "of" in written else {}
        return {**cls.gives, **single, **masses.named_outputs(written.get("list"))}

    def items(self, output: str) -> int | None:
        """How many there are, where they are listed or counted; None of what is but one."""
        several = type(self).gives.get(output)
        if several is None or not several.type.shape or several.type.shape[0] is not None:
            return None
        if self.list is not None:
            return len(self.list)
        return None if self.fill is None else self.fill.count

    def fillings(self) -> Iterable[tuple[Ref, Callable[[Floats, Floats], None]]]:
        """The object that they fill at a spacing."""
        return () if self.fill is None or self.fill.spacing is None else ((self.fill.object, self.fill.bounded),)

    def insides(self) -> Iterable[Ref]:
        """The object that they fill or are born in."""
        within = None if self.emit is None else self.emit.within
        return [ref for ref in (None if self.fill is None else self.fill.object, within) if ref is not None]

    def static_masses(self) -> Mapping[str, StaticMass]:
        """Listed ones; else one for all of them, whose place is not told."""
        if self.list is None:
            return {"": StaticMass(self.mass, None, self.velocity if self.emit is None else None)}
        return {name: StaticMass(one.mass, one.position, one.velocity, one.fixed) for name, one in self.list.items()}

    def assemble(self, name: str, assembly: Assembly) -> Bodies:
        """Reserve the masses."""
        import numpy as np

        default = 0.05 if self.radius is None else self.radius
        if self.list is not None:
            each = tuple(self.list.values())
            return masses.reserve(
                name,
                assembly,
                positions=np.array([p.position for p in each]),
                velocities=np.array([p.velocity for p in each]),
                masses=np.array([p.mass for p in each]),
                radii=np.array([default if p.radius is None else p.radius for p in each]),
                fixed=np.array([p.fixed for p in each]),
            )
        if self.emit is not None:
            n = int(self.emit.capacity())
            nothing = np.zeros((n, 3))
            where = nothing + (assembly.initial(self.emit.from_) if self.emit.from_.constant else 0.0)
            room = masses.reserve(name, assembly, where, nothing, np.zeros(n), np.zeros(n), np.ones(n, dtype=bool))
            self.emit.assemble(name, assembly, room, self.mass, default)
            return room
        if self.fill is not None:
            places = filled(self.fill, name, assembly)
        elif self.positions is not None:
            places = np.asarray(assembly.initial(self.positions), dtype=float).reshape(-1, 3)
        else:
            places, default = self._object(assembly)
        n = len(places)
        return masses.reserve(
            name,
            assembly,
            positions=places,
            velocities=np.tile(self.velocity, (n, 1)),
            masses=np.full(n, self.mass),
            radii=np.full(n, default),
            fixed=np.zeros(n, dtype=bool),
        )

    def assemble_part(
        self, name: str, assembly: Assembly, bodies: Bodies, start: ModelState, first: int, last: int
    ) -> Bodies | None:
        """Any part of them; of those that are born and die any part of the room for them."""
        part = masses.reserve_part(assembly, bodies, start, first, last)
        if self.emit is not None:
            self.emit.assemble_part(name, assembly, part, start, first)
        return part

    def _object(self, assembly: Assembly) -> tuple[Floats, float]:
        """Place (1, 3) [m] and radius [m] of the object at the start."""
        import numpy as np

        assert self.of is not None
        driven = assembly.object(self.of)
        place = getattr(driven, "position", None)
        assert isinstance(place, Value)  # the compiler has refused others
        start = np.asarray(assembly.initial(place), dtype=float).reshape(1, 3)
        if self.radius is not None:
            return start, self.radius
        for name, part in (("radius", 1.0), ("size", 0.5)):
            extent = getattr(driven, name, None)
            if isinstance(extent, Value):
                return start, part * float(np.min(assembly.initial(extent)))
        return start, 0.05

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual, and ``name.position``, ``name.velocity``, ``name.acceleration``."""
        bodies, state, ages = self._seen(state)
        if output == "ages":
            return ages
        if output in masses.BODY_OUTPUTS:
            return masses.read(output, bodies, state)
        if "." not in output:
            return masses.read_named(f"of.{output}", {"of": 0}, bodies, state)
        return masses.read_named(output, masses.numbered(self.list or ()), bodies, state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the masses, and those with names; none where they come and go."""
        assert state.bodies is not None
        if self.emit is not None:
            return None
        if "." in output:
            return masses.places_named(output, masses.numbered(self.list or ()), state.bodies)
        named = masses.places_named(f"of.{output}", {"of": 0}, state.bodies)
        return masses.places(output, state.bodies) if named is None else named

    def _seen(self, state: ModelState) -> tuple[Bodies, ModelState, Floats]:
        """Living particles as bodies, their state, and their ages (n,) [s]."""
        import numpy as np

        assert state.bodies is not None
        if self.emit is not None:
            return self.emit.living(state.bodies, state)
        return state.bodies, state, np.full(state.bodies.count, state.t)

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Spheres]:
        """Spheres of the particles' radii, those that age in classes of age."""
        import numpy as np

        from sceneql.frame import Points as Spheres

        bodies, state, ages = self._seen(state)
        places, radii = masses.positions(bodies, state).copy(), masses.radii(bodies, state).copy()
        if self.aging is None:
            surface = moment.surface(name, self.material, self.color)
            listed = [one.color for one in (self.list or {}).values()]
            colors = [surface.color if color is None else linear(moment.at(color)) for color in listed]
            if not any(listed) and self.material is None and self.color is None:
                colors = [default_color(k) for k in range(len(listed))]
            own = any(listed) or len(set(colors)) > 1
            yield Spheres(name, surface, places, radii, np.array(colors) if own else None)
            return
        for color, some, sizes in self.aging.classes(ages, radii):
            surface = moment.surface(name, self.material, self.color if color is None else color)
            yield Spheres(name, surface, places[some], sizes)

    def lowest(self) -> float | None:
        """Of those that are listed, or given by constant points."""
        radius = 0.05 if self.radius is None else self.radius
        if self.list is not None:
            return min(one.position[1] - (radius if one.radius is None else one.radius) for one in self.list.values())
        if self.positions is not None and self.positions.constant:
            return min((float(point[1]) for point in self.positions.number()), default=0.0) - radius
        return None

    def drives(self) -> Mapping[str, Mapping[str, str]]:
        """The position of the object that is the particle."""
        return {} if self.of is None else {self.of.name: {"position": "position"}}

    def with_own_shapes(self, own: Callable[[Ref], Ref]) -> Particles:
        """Itself with an object of its own."""
        return self if self.of is None else self.model_copy(update={"of": own(self.of)})
