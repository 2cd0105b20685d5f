"""mass_spring: masses and the springs between them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import ValidationError, ValidationInfo, field_validator, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

from sceneql.kinds import (
    Color,
    Damping,
    FixedLength,
    FixedMass,
    FixedVelocity,
    Gives,
    MaterialRef,
    Model,
    Moment,
    Quantity,
    Stiffness,
    field,
    quantity_type,
)
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Type
from sceneql.simulation import bodies as point_masses
from sceneql.simulation.models.nets import CORNERS, EDGES, SIDES, Cloth, Lattice, MassPoint, Net, Rope, Spring, turned

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly, Bodies, ModelState, Slopes

PLACES = {"lattice": SIDES, "cloth": (*EDGES, *CORNERS), "rope": ("start", "end")}
SPRING_OUTPUTS = {
    "length": Gives(quantity_type(dim.LENGTH), "Length of the spring."),
    "tension": Gives(quantity_type(dim.FORCE), "Force of its stretch, > 0 when it pulls (without damping)."),
}
MOST_COILS = 40


class MassSpring(Model):
    """Point masses tied by springs: m a = F + sum of (k (L - L0) + c dL/dt) along each spring.

    Named masses and springs, or a whole ``lattice``, ``cloth`` or ``rope``. Damping acts along the springs, so that it
    leaves momentum and angular momentum alone; its power is counted as dissipated. Sources: Hooke, De potentia
    restitutiva (1678); Provot, Deformation constraints in a mass-spring model (1995).
    """

    gives: ClassVar[Mapping[str, Gives]] = {
        **point_masses.BODY_OUTPUTS,
        "stretch": Gives(Type(), "Largest |L - L0| / L0 of a spring."),
        "springs": Gives(quantity_type(dim.LENGTH, (None, 2, 3)), "The two ends of every spring."),
    }

    masses: dict[str, MassPoint] | None = field("Masses by name.", None)
    springs: tuple[Spring, ...] = field("Springs between named masses.", ())
    lattice: Lattice | None = field("A block of masses.", None)
    cloth: Cloth | None = field("A sheet of masses.", None)
    rope: Rope | None = field("A line of masses.", None)
    mass: FixedMass = field("Mass of each that says nothing else.", "0.1 kg", above=0)
    stiffness: Stiffness = field("Force for a stretch, of each spring that says nothing else.", "100 N/m", above=0)
    damping: Damping = field("Force for a speed of stretching, likewise.", "0 N*s/m", at_least=0)
    pins: tuple[str, ...] = field(
        "Masses that never move: names; of a lattice left, right, bottom, top, back, front; of a cloth left, right, "
        "bottom, top and corners such as top_left; of a rope start, end; or a number, counted from 0.",
        (),
    )
    velocity: FixedVelocity = field("Velocity of all at the start.", "0 0 0 m/s")
    spin: Annotated[tuple[float, float, float], Quantity(dim.FREQUENCY, (3,))] = field(
        "Angular velocity at the start, about the center of mass [rad/s].", "0 0 0 rad/s"
    )
    radius: FixedLength | None = field(
        "Radius of the masses in contacts and in the picture; by default a tenth of the shortest spring.",
        None,
        at_least=0,
    )
    look: Literal["auto", "coil", "line", "masses"] = field(
        "How it draws itself: springs as coils or lines, or not at all; auto: coils when few, a cloth as a sheet.",
        "auto",
    )
    material: MaterialRef | None = field("How it looks where no object draws it.", None)
    color: Color | None = field("Color in place of the material's.", None)

    @field_validator("springs")
    @classmethod
    def _tie_known_masses(cls, springs: tuple[Spring, ...], info: ValidationInfo) -> tuple[Spring, ...]:
        known = info.data.get("masses") or {}
        help = f"there are {', '.join(known)}" if known else "give `masses` by name"
        wrong = [
            InitErrorDetails(
                type=PydanticCustomError(
                    "unknown_mass", "no mass is called '{name}'; {help}", {"name": name, "help": help}
                ),
                loc=(k, "between", end),
                input=name,
            )
            for k, spring in enumerate(springs)
            for end, name in enumerate(spring.between)
            if name not in known
        ]
        if wrong:
            raise ValidationError.from_exception_data(cls.__name__, wrong)
        return springs

    @field_validator("pins")
    @classmethod
    def _pin_known_masses(cls, pins: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        known: set[str] = set(info.data.get("masses") or ())
        known |= {place for shape, places in PLACES.items() if info.data.get(shape) for place in places}
        for pin in pins:
            if pin not in known and not pin.isdecimal():
                raise ValueError(f"no mass is called '{pin}'; a pin is one of {', '.join(sorted(known))}, or a number")
        return pins

    @model_validator(mode="after")
    def _is_one_net(self) -> MassSpring:
        given = [name for name in ("masses", *PLACES) if getattr(self, name) is not None]
        if len(given) != 1:
            said = f", not {' and '.join(given)}" if given else ""
            raise ValueError(f"a mass_spring has one of `masses`, `lattice`, `cloth` and `rope`{said}")
        if self.masses is not None and not self.masses:
            raise ValueError("no masses are given")
        count = len(self.masses) if self.masses is not None else self._shaped().mass_count()
        for pin in self.pins:
            if pin.isdecimal() and int(pin) >= count and pin not in (self.masses or ()):
                raise ValueError(f"pin {pin}: the {count} masses are counted from 0")
        return self

    def _shaped(self) -> Lattice | Cloth | Rope:
        shaped = self.lattice or self.cloth or self.rope
        assert shaped is not None
        return shaped

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all masses; named masses and springs add theirs: ``bob.position``, ``tether.tension``."""
        springs = written.get("springs")
        entries = springs if isinstance(springs, list | tuple) else [springs]
        named = [str(entry["name"]) for entry in entries if isinstance(entry, Mapping) and entry.get("name")]
        more = {f"{name}.{output}": gives for name in named for output, gives in SPRING_OUTPUTS.items()}
        return {**cls.gives, **point_masses.named_outputs(written.get("masses")), **more}

    @cached_property
    def net(self) -> Net:
        """Masses and springs, before any rotation at the start."""
        import numpy as np

        if self.masses is None:
            return self._shaped().net()
        names = list(self.masses)
        pairs = [[names.index(end) for end in spring.between] for spring in self.springs]
        return Net(
            points=np.array([mass.position for mass in self.masses.values()]),
            pairs=np.array(pairs, dtype=np.int64).reshape(-1, 2),
            stiffness=np.ones(len(pairs)),
            places={name: k for k, name in enumerate(names)},
        )

    @cached_property
    def rest(self) -> Floats:
        """(m,) lengths of the springs without force [m]."""
        import numpy as np

        ends = self.net.points[self.net.pairs]
        rest: Floats = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        for k, spring in enumerate(self.springs):
            if spring.rest is not None:
                rest[k] = spring.rest
        return rest

    @cached_property
    def size(self) -> float:
        """Radius of the masses [m]."""
        if self.radius is not None:
            return self.radius
        some = self.rest[self.rest > 0]
        return 0.1 * min(map(float, some)) if len(some) else 0.05

    def assemble(self, name: str, assembly: Assembly) -> Bodies:
        """Reserve the masses and add the forces of the springs."""
        import numpy as np

        from sceneql.simulation.models.mass_spring_kernels import BLOCK

        net, points = self.net, self.net.points
        n, m = len(net.points), len(net.pairs)
        if self.lattice is not None and self.lattice.rotation is not None:
            points = turned(points, self.lattice.center, assembly.initial(self.lattice.rotation))
        fixed = np.zeros(n, dtype=bool)
        for pin in self.pins:
            fixed[net.places[pin] if pin in net.places else int(pin)] = True
        each = tuple((self.masses or {}).values())
        weights = np.full(n, self.mass)
        velocities = np.tile(self.velocity, (n, 1))
        for k, mass in enumerate(each):
            fixed[k] |= mass.fixed
            weights[k] = self.mass if mass.mass is None else mass.mass
            velocities[k] = self.velocity if mass.velocity is None else mass.velocity
        velocities += np.cross(self.spin, points - np.average(points, axis=0, weights=weights))
        velocities[fixed] = 0.0
        bodies = point_masses.reserve(name, assembly, points, velocities, weights, np.full(n, self.size), fixed)

        blocks = np.zeros((m, BLOCK))
        blocks[:, 0], blocks[:, 2], blocks[:, 4] = self.rest, net.stiffness, net.stiffness
        for spring, block in zip(self.springs, blocks, strict=False):
            if spring.stiffness is not None:
                block[1:3] = spring.stiffness, 0.0
            if spring.damping is not None:
                block[3:5] = spring.damping, 0.0
        blocks_at, stiffness_at = assembly.floats(blocks.ravel()), assembly.value(self.stiffness)
        ints = (bodies.position_at, bodies.velocity_at, bodies.work_at, blocks_at, stiffness_at)
        more = (assembly.value(self.damping), m, *net.pairs.ravel().tolist())
        damped = bool(np.any(blocks[:, 3])) or not self.damping.constant or assembly.initial(self.damping) != 0.0
        assembly.term(
            "internal",
            "sceneql.simulation.models.mass_spring_kernels:springs",
            (*ints, *more),
            lambda: _slopes(net, bodies, damped),
        )
        assembly.remember(blocks_at, stiffness_at)
        return bodies

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual, and those of named masses and springs."""
        import numpy as np

        from sceneql.simulation.models.mass_spring_kernels import BLOCK, energy

        assert state.bodies is not None
        blocks_at, stiffness_at = state.ints
        if output in point_masses.BODY_OUTPUTS:
            own = 0.0
            if output in ("potential", "energy"):
                at = state.bodies.position_at
                own = energy(state.y, at, state.floats, blocks_at, stiffness_at, self.net.pairs)
            return point_masses.read(output, state.bodies, state, own)
        ends = point_masses.positions(state.bodies, state)[self.net.pairs]
        if output == "springs":
            return ends
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        if output == "stretch":
            stretched = self.rest > 0
            parts = np.abs(lengths[stretched] - self.rest[stretched]) / self.rest[stretched]
            return float(np.max(parts)) if len(parts) else 0.0
        name, _, what = output.rpartition(".")
        if what in SPRING_OUTPUTS:
            k = [spring.name for spring in self.springs].index(name)
            if what == "length":
                return float(lengths[k])
            own, part = state.floats[blocks_at + BLOCK * k + 1 : blocks_at + BLOCK * k + 3]
            return float((own + part * state.floats[stiffness_at]) * (lengths[k] - self.rest[k]))
        return point_masses.read_named(output, tuple(self.masses or ()), state.bodies, state)

    def fastest(self, name: str) -> tuple[Oscillation, ...]:
        """The fastest spring, and the one that is damped most, by the stiffness at both its ends.

        (angular frequency)^2 <= max over springs of the sum over springs at its ends of k |cos| / m: the rows of the
        matrix that acts on the springs' stretches (Gershgorin 1931; Anderson & Morley 1985). Sharp for a single spring.
        """
        stiffness = self.stiffness.number() if self.stiffness.constant else None
        damping = self.damping.number() if self.damping.constant else None
        if self.masses is None:
            if stiffness is None or damping is None:
                return ()
            factor = self._shaped().stiffest() / self.mass
            shape = next(shape for shape in PLACES if getattr(self, shape) is not None)
            found = Oscillation(math.sqrt(factor * stiffness), factor * damping, f"the springs of '{name}'", (shape,))
            return (found,)
        given = [
            (
                stiffness if spring.stiffness is None else spring.stiffness,
                damping if spring.damping is None else spring.damping,
            )
            for spring in self.springs
        ]
        told = [(k, c) for k, c in given if k is not None and c is not None]
        if len(told) < len(given) or not told:
            return ()
        squares, decays = (self._rows([pair[which] for pair in told]) for which in (0, 1))
        worst = {max(range(len(told)), key=rows.__getitem__) for rows in (squares, decays) if any(rows)}
        return tuple(
            Oscillation(math.sqrt(squares[k]), decays[k], f"spring {self._spring_name(k)}", ("springs", k))
            for k in sorted(worst)
        )

    def _spring_name(self, k: int) -> str:
        spring = self.springs[k]
        return f"'{spring.name}'" if spring.name else f"'{spring.between[0]}'-'{spring.between[1]}'"

    def _rows(self, weights: Sequence[float]) -> list[float]:
        """For each spring the sum over springs at its ends of weight |cos of the angle between them| / mass."""
        masses = self.masses or {}
        pinned = {pin if pin in masses else list(masses)[int(pin)] for pin in self.pins}
        inverse = {
            name: 0.0 if mass.fixed or name in pinned else 1.0 / (self.mass if mass.mass is None else mass.mass)
            for name, mass in masses.items()
        }
        directions: list[tuple[float, ...]] = []
        at: dict[str, list[int]] = {name: [] for name in masses}
        for k, spring in enumerate(self.springs):
            start, end = (masses[name].position for name in spring.between)
            length = math.dist(start, end)
            directions.append(tuple((b - a) / length for a, b in zip(start, end, strict=True)) if length else ())
            for name in spring.between:
                at[name].append(k)

        def cosine(k: int, other: int) -> float:
            if not directions[k] or not directions[other]:
                return 1.0
            return abs(sum(a * b for a, b in zip(directions[k], directions[other], strict=True)))

        return [
            sum(
                weights[other] * (1.0 if other == k else cosine(k, other)) * inverse[name]
                for name in spring.between
                for other in at[name]
            )
            for k, spring in enumerate(self.springs)
        ]

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Shape]:
        """A cloth as a sheet, else masses as spheres and springs as coils or lines."""
        from sceneql.simulation.models import spring_look

        assert state.bodies is not None
        surface = moment.surface(name, self.material, self.color)
        places = point_masses.positions(state.bodies, state).copy()
        if self.net.triangles is not None and self.look == "auto":
            yield spring_look.sheet(name, surface, places, self.net.triangles, 0.5 * self.size)
            return
        yield spring_look.spheres(name, surface, places, self.size)
        few = len(self.net.pairs) <= MOST_COILS
        if self.look == "coil" or (self.look == "auto" and few and self.rope is None):
            yield spring_look.coils(name, surface, places[self.net.pairs], self.rest, self.size)
        elif self.look != "masses":
            radius = self.size if self.rope is not None else 0.15 * self.size
            yield spring_look.lines(name, surface, places[self.net.pairs], radius)


def _slopes(net: Net, bodies: Bodies, damped: bool) -> Slopes:
    """Of each spring four blocks of 3x3 by positions; if damped, as many by velocities."""
    import numpy as np

    from sceneql.system import Slopes

    ends = 3 * net.pairs
    places = np.arange(3)
    rows = np.repeat(np.repeat(ends, 2, axis=1)[:, :, None] + places, 3, axis=2).ravel() + bodies.velocity_at
    columns = np.tile(np.tile(ends, 2)[:, :, None] + places, 3).ravel()
    by = [bodies.position_at, bodies.velocity_at] if damped else [bodies.position_at]
    return Slopes(
        "sceneql.simulation.models.mass_spring_slopes_kernels:springs",
        np.tile(rows, len(by)),
        np.concatenate([columns + at for at in by]),
    )
