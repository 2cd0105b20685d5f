"""particles: point masses that feel forces and contacts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import model_validator

from sceneql.kinds import (
    Color,
    FixedLength,
    FixedMass,
    FixedPosition,
    FixedVelocity,
    Gives,
    MaterialRef,
    Model,
    Moment,
    ObjectRef,
    Points,
    Record,
    Value,
    field,
)
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.simulation import bodies as masses

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.frame import Points as Spheres
    from sceneql.system import Assembly, Bodies, ModelState


class Particle(Record):
    """One named particle."""

    mass: FixedMass = field("Its mass.", "1 kg", above=0)
    position: FixedPosition = field("Where it starts.", "0 0 0 m")
    velocity: FixedVelocity = field("How fast it starts.", "0 0 0 m/s")
    radius: FixedLength | None = field(
        "Its radius in contacts and in the picture; by default the model's.", None, at_least=0
    )
    fixed: bool = field("It never moves.", False)

    @model_validator(mode="after")
    def _rests_if_fixed(self) -> Particle:
        if self.fixed and any(self.velocity):
            raise ValueError("a fixed particle has no velocity")
        return self


class Particles(Model):
    """Point masses: m a = F (Newton 1687), where F is what the scene's forces and contacts do to them.

    They are listed by name (``list``), or come from an object that they then drive (``of``: its place at the start and
    its radius are read from it), or from points (``positions``), all with the same mass.
    """

    gives: ClassVar[Mapping[str, Gives]] = masses.BODY_OUTPUTS

    list: dict[str, Particle] | None = field("Particles by name.", None)
    of: ObjectRef | None = field("The object that is the particle, and that it drives.", None)
    positions: Points | None = field("Where particles start, when they need no names.", None)
    mass: FixedMass = field("Mass of each, with `of` and `positions`.", "1 kg", above=0)
    velocity: FixedVelocity = field("Velocity at the start, with `of` and `positions`.", "0 0 0 m/s")
    radius: FixedLength | None = field(
        "Radius in contacts and in the picture; by default the object's (a box: half its least side), else 0.05 m.",
        None,
        at_least=0,
    )
    material: MaterialRef | None = field("How they look where no object draws them.", None)
    color: Color | None = field("Color in place of the material's.", None)

    @model_validator(mode="after")
    def _come_from_one_place(self) -> Particles:
        given = [name for name in ("list", "of", "positions") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                "particles come from one of `list`, `of` and `positions`"
                + (f", not from {' and '.join(given)}" if given else "")
            )
        if self.list is not None and not self.list:
            raise ValueError("the list of particles is empty")
        return self

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all masses; named ones add ``name.position`` and so on, one `of` an object adds ``position``."""
        single = masses.MASS_OUTPUTS if "of" in written else {}
        return {**cls.gives, **single, **masses.named_outputs(written.get("list"))}

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
        if self.positions is not None:
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

    def _object(self, assembly: Assembly) -> tuple[Floats, float]:
        """Place (1, 3) and radius of the object at the start."""
        import numpy as np

        assert self.of is not None
        driven = assembly.object(self.of)
        place = getattr(driven, "position", None)
        if not isinstance(place, Value):
            word = type(driven).__name__.lower()
            message = f"'{self.of.name}' is a {word}, which has no position that a particle could drive"
            raise ScriptError([Diagnostic("no-position", message, self.of.span)])
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
        assert state.bodies is not None
        if output in masses.BODY_OUTPUTS:
            return masses.read(output, state.bodies, state)
        if "." not in output:
            return masses.read_named(f"of.{output}", ("of",), state.bodies, state)
        return masses.read_named(output, tuple(self.list or ()), state.bodies, state)

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Spheres]:
        """Spheres of the particles' radii."""
        from sceneql.frame import Points as Spheres

        assert state.bodies is not None
        surface = moment.surface(name, self.material, self.color)
        yield Spheres(
            name, surface, masses.positions(state.bodies, state).copy(), masses.radii(state.bodies, state).copy()
        )

    def drives(self) -> Mapping[str, tuple[str, str]]:
        """The position of the object that is the particle."""
        return {} if self.of is None else {self.of.name: ("position", "position")}
