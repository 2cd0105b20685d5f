"""mass_spring: masses and the springs between them."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sceneql.bodies import bodies as point_masses
from sceneql.bodies.nets import (
    CORNERS,
    EDGES,
    ROPE_ENDS,
    SIDES,
    Cloth,
    Lattice,
    MassPoint,
    Net,
    Rope,
    Spring,
    alike,
    turned,
)
from sceneql.bodies.solid_lattice import Filling
from sceneql.bodies.springs import SpringModel, pin_problems
from sceneql.kinds import Clock, Damping, Doubt, FixedMass, Gives, Problem, Ref, Stiffness, field, quantity_type
from sceneql.kinds.stable_step import Oscillation, StaticMass, StaticScene
from sceneql.language.repeat import copy_meant
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import STRONG, Diagnostic, ScriptError, suggestion
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.system import Assembly, ModelState

PLACES: Mapping[str, tuple[str, ...]] = {
    "lattice": SIDES,
    "cloth": (*EDGES, *CORNERS),
    "rope": ("start", "end"),
    "solid": SIDES,
}
SOLID_OUTPUTS = {
    "volume": Gives(
        quantity_type(dim.VOLUME),
        "What the tetrahedra of a solid hold, those with a torn edge left out.",
        computed=True,
    ),
    "inverted": Gives(Type(), "How many tetrahedra of a solid are turned inside out.", computed=True),
}
SPRING_OUTPUTS = {
    "length": Gives(quantity_type(dim.LENGTH), "Length of the spring.", computed=True),
    "tension": Gives(
        quantity_type(dim.FORCE), "Force of its stretch, > 0 when it pulls (without damping).", computed=True
    ),
}


BETWEEN = (
    "springs hold masses of this model: write `masses: {{{name}: {{position: 0 1 0 m, mass: 1 kg}}}}`, and an object"
    " follows a mass by its `position: MODEL.{name}`"
)


class MassSpring(SpringModel):
    """Point masses tied by springs: m a = F + sum of (k (L - L0) + c dL/dt) along each spring.

    Named masses and springs, a whole ``lattice``, ``cloth`` or ``rope``, or a ``solid`` of any shape. Damping acts
    along the springs, so that it leaves momentum and angular momentum alone; its power is counted as dissipated.
    Sources: Hooke, De potentia restitutiva (1678); Provot, Deformation constraints in a mass-spring model (1995).
    """

    masses: dict[str, MassPoint] | None = field("Masses by name.", None)
    springs: tuple[Spring, ...] = field("Springs between named masses.", ())
    lattice: Lattice | None = field("A block of masses.", None)
    cloth: Cloth | None = field("A sheet of masses.", None)
    rope: Rope | None = field("A line of masses.", None)
    solid: Filling | None = field(
        "Masses that fill an object; of tetrahedra it tells `volume` and how many are `inverted`.", None
    )
    mass: FixedMass = field("Mass of each that says nothing else.", "0.1 kg", above=0)
    stiffness: Stiffness = field("Force for a stretch, of each spring that says nothing else.", "100 N/m", above=0)
    damping: Damping = field("Force for a speed of stretching, likewise.", "0 N*s/m", at_least=0)

    def lowest(self) -> float | None:
        """Of all nets but a solid."""
        named = [one.position[1] for one in (self.masses or {}).values()]
        lows = [*named, *(net.lowest() for net in (self.lattice, self.cloth, self.rope) if net is not None)]
        return min(lows) - (self.radius or 0.0) if lows else None

    def problems(self) -> Iterator[Problem]:
        """Several nets or none, springs to masses that are not there, and pins of none."""
        known = self.masses or {}
        named = f"there are {', '.join(known)}" if known else "give `masses` by name"
        for k, spring in enumerate(self.springs):
            for end, name in enumerate(spring.between):
                if name not in known:
                    help = copy_meant(name, known) or suggestion(name, known, STRONG) or BETWEEN.format(name=name)
                    yield Problem(f"no mass is called '{name}'; {named}", ("springs", k, "between", end), help=help)
        given = [name for name in ("masses", *PLACES) if getattr(self, name) is not None]
        if len(given) != 1:
            said = f", not {' and '.join(given)}" if given else ""
            text = f"a mass_spring has one of `masses`, `lattice`, `cloth`, `rope` and `solid`{said}"
            yield Problem(text, tuple(given[1:2]), at_key=True)
            return
        if self.masses is not None and not self.masses:
            yield Problem("no masses are given", ("masses",))
        yield from pin_problems(self.pins, (*known, *PLACES.get(given[0], ())), self.mass_count())

    def doubts(self, clock: Clock) -> Iterator[Doubt]:
        """A stiffness or damping for springs that say nothing else, where each says its own."""
        for name in ("stiffness", "damping") if self.masses and self.springs else ():
            place = getattr(self, name).span
            if place is not None and all(getattr(spring, name) is not None for spring in self.springs):
                text = f"no spring reads its `{name}`: each has one of its own"
                yield Doubt(
                    "unread-value", text, place, f"leave out one of the two; a spring's own is `springs.0.{name}`"
                )

    def faceless(self) -> str:
        """Of all nets but a cloth and a solid, and of what tears."""
        if self.cloth is None and self.solid is None:
            return super().faceless()
        return "tears" if self.tear is not None else ""

    def mass_count(self) -> int | None:
        """Number of masses; None of a solid."""
        shape = self.lattice or self.cloth or self.rope
        return len(self.masses) if self.masses is not None else shape.mass_count() if shape else None

    def burdens(self, density: float) -> bool:
        """All but a solid of that density."""
        return self.solid is None or self.solid.density != density

    def static_net(self) -> tuple[float, int] | None:
        """All but that of single masses."""
        if self.lattice is not None:
            return self.lattice.spacing, sum(count > 1 for count in self.lattice.count)
        if self.cloth is not None:
            return min(side / n for side, n in zip(self.cloth.size, self.cloth.cells, strict=True)), 2
        if self.rope is not None:
            return math.dist(self.rope.from_, self.rope.to) / (self.rope.count - 1), 1
        return None if self.solid is None else (self.solid.spacing, 3)

    def fillings(self) -> Iterable[tuple[Ref, Callable[[Floats, Floats], None]]]:
        """The object of a solid."""
        return () if self.solid is None else ((self.solid.object, self.solid.bounded),)

    def insides(self) -> Iterable[Ref]:
        """The object of a solid."""
        return () if self.solid is None else (self.solid.object,)

    def shown_in_place_of(self) -> Iterable[Ref]:
        """The object of a solid."""
        return self.insides()

    def shown_at(self, outputs: Collection[str]) -> bool:
        """What stands at one mass shows no spring."""
        own = {output.partition(".")[0] for output in outputs}
        return not self.springs or self.masses is None or len(own) != 1 or not own <= set(self.masses)

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all masses; named masses and springs add theirs: ``bob.position``, ``tether.tension``."""
        springs = written.get("springs")
        entries = springs if isinstance(springs, list | tuple) else [springs]
        named = [str(entry["name"]) for entry in entries if isinstance(entry, Mapping) and entry.get("name")]
        more = {f"{name}.{output}": gives for name in named for output, gives in SPRING_OUTPUTS.items()}
        solid = SOLID_OUTPUTS if "solid" in written else {}
        ends = (*(ROPE_ENDS if "rope" in written else ()), *(CORNERS if "cloth" in written else ()))
        single = point_masses.named_outputs(written.get("masses")) | point_masses.named_outputs(dict.fromkeys(ends))
        return {**cls.gives, **single, **more, **solid}

    def make(self, assembly: Assembly) -> tuple[Net, Floats, Floats]:
        """The net with the numbers of single masses and springs."""
        import numpy as np

        net = self._net(assembly)
        weights = np.full(len(net.points), self.mass) if net.masses is None else net.masses.copy()
        blocks = alike(net)
        if self.lattice is not None and self.lattice.rotation is not None:
            points = turned(net.points, self.lattice.center, assembly.initial(self.lattice.rotation))
            net = replace(net, points=points)
        for k, mass in enumerate((self.masses or {}).values()):
            weights[k] = self.mass if mass.mass is None else mass.mass
        for spring, block in zip(self.springs, blocks, strict=False):
            if spring.rest is not None:
                block[0] = spring.rest
            if spring.stiffness is not None:
                block[1:3] = spring.stiffness, 0.0
            if spring.damping is not None:
                block[3:5] = spring.damping, 0.0
        return net, weights, blocks

    def _net(self, assembly: Assembly) -> Net:
        """Net of masses and springs, before any rotation at the start."""
        import numpy as np

        if self.solid is not None:
            net = self.solid.net(assembly)
            for pin in self.pins:
                if pin.isdecimal() and float(pin) >= len(net.points):
                    message = f"pin {pin}: the {len(net.points)} masses are counted from 0"
                    raise ScriptError([Diagnostic("invalid", message, self.solid.object.span)])
            return net
        shape = self.lattice or self.cloth or self.rope
        if shape is not None:
            return shape.net()
        assert self.masses is not None
        names = list(self.masses)
        pairs = [[names.index(end) for end in spring.between] for spring in self.springs]
        return Net(
            points=np.array([mass.position for mass in self.masses.values()]),
            pairs=np.array(pairs, dtype=np.int64).reshape(-1, 2),
            stiffness=np.ones(len(pairs)),
            places={name: k for k, name in enumerate(names)},
        )

    def shared(self, assembly: Assembly) -> tuple[int, int]:
        """Its own stiffness and damping."""
        return assembly.value(self.stiffness), assembly.value(self.damping)

    def damped(self, blocks: Floats) -> bool:
        """Whether any spring may be damped, now or later."""
        always = self.damping.constant and self.damping.number() == 0.0
        return super().damped(blocks) or (not always and bool(blocks[:, 4].any()))

    def start_velocities(self, count: int) -> Floats:
        """Those of single masses, else the model's."""
        velocities = super().start_velocities(count)
        for k, mass in enumerate((self.masses or {}).values()):
            if mass.velocity is not None:
                velocities[k] = mass.velocity
        return velocities

    def held(self, net: Net) -> Any:
        """Pins and fixed masses."""
        fixed = super().held(net)
        for k, mass in enumerate((self.masses or {}).values()):
            fixed[k] |= mass.fixed
        return fixed

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual, and those of named masses and springs."""
        import numpy as np

        from sceneql.bodies.mass_spring_kernels import BLOCK

        assert state.bodies is not None
        if output in self.gives:
            return super().read(output, state)
        if output in SOLID_OUTPUTS:
            from sceneql.bodies.filling.tetrahedra import volumes

            held = volumes(point_masses.positions(state.bodies, state), self.tetrahedra(state))
            return float(held.sum() if output == "volume" else np.count_nonzero(held < 0.0))
        name, _, what = output.rpartition(".")
        if what not in SPRING_OUTPUTS:
            return super().read(output, state)
        blocks_at, stiffness_at, _ = state.ints
        k = [spring.name for spring in self.springs].index(name)
        a, b = point_masses.positions(state.bodies, state)[self.net.pairs[k]]
        length = float(np.linalg.norm(b - a))
        if what == "length":
            return length
        own, part = state.floats[blocks_at + BLOCK * k + 1 : blocks_at + BLOCK * k + 3]
        return float((own + part * state.floats[stiffness_at]) * (length - self.rest[k]))

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the masses, those with names too."""
        assert state.bodies is not None
        return None if output in SOLID_OUTPUTS else super().places(output, state)

    def static_masses(self) -> Mapping[str, StaticMass]:
        """Named ones; else one for all of them, whose place is not told, and none of a solid's by its density."""
        if self.masses is None:
            alike = self.solid is None or self.solid.density is None
            return {"": StaticMass(self.mass, None, self.velocity)} if alike else {}
        names = list(self.masses)
        pinned = {names[int(pin)] if pin not in self.masses else pin for pin in self._named_pins()}
        return {
            name: StaticMass(
                self.mass if one.mass is None else one.mass,
                one.position,
                self.velocity if one.velocity is None else one.velocity,
                fixed=one.fixed or name in pinned,
            )
            for name, one in self.masses.items()
        }

    def _named_pins(self) -> list[str]:
        """Pins that are names or numbers of masses."""
        return [pin for pin in self.pins if not isinstance(self.pins, dict) or self.pins[pin].where is None]

    def fastest(self, name: str, scene: StaticScene) -> tuple[Oscillation, ...]:
        """The fastest spring, and the one that is damped most, by the stiffness at both its ends.

        (angular frequency)^2 <= max over springs of the sum over springs at its ends of k |cos| / m: the rows of the
        matrix that acts on the springs' stretches (Gershgorin 1931; Anderson & Morley 1985). Sharp for a single spring.
        """
        stiffness = self.stiffness.number() if self.stiffness.constant else None
        damping = self.damping.number() if self.damping.constant else None
        if self.masses is None:
            if stiffness is None or damping is None:
                return ()
            shape = self.lattice or self.cloth or self.rope
            if self.solid is not None:
                square, decay = self.solid.fastest(stiffness, damping, self.mass)
            else:
                assert shape is not None
                square, decay = (shape.stiffest() * of / self.mass for of in (stiffness, damping))
            field_name = next(shape for shape in PLACES if getattr(self, shape) is not None)
            return (Oscillation(math.sqrt(square), decay, f"the springs of '{name}'", (field_name,)),)
        given = [
            (
                stiffness if spring.stiffness is None else spring.stiffness,
                damping if spring.damping is None else spring.damping,
            )
            for spring in self.springs
        ]
        static_masses = [(k, c) for k, c in given if k is not None and c is not None]
        if len(static_masses) < len(given) or not static_masses:
            return ()
        rows = [self._rows([pair[which] for pair in static_masses]) for which in (0, 1)]
        squares, decays = ([sum(row.values()) for row in each] for each in rows)
        culprits: dict[int, int] = {}
        for sums, each in zip((squares, decays), rows, strict=True):
            k = max(range(len(static_masses)), key=sums.__getitem__)
            if sums[k] > 0.0:
                # The largest row may belong to a soft spring beside the stiff one that makes it large.
                culprits[k] = max(each[k], key=each[k].__getitem__)
        return tuple(
            Oscillation(math.sqrt(squares[k]), decays[k], f"spring {self._spring_name(of)}", ("springs", of))
            for k, of in sorted(culprits.items())
        )

    def _spring_name(self, k: int) -> str:
        spring = self.springs[k]
        return f"'{spring.name}'" if spring.name else f"'{spring.between[0]}'-'{spring.between[1]}'"

    def _rows(self, weights: Sequence[float]) -> list[dict[int, float]]:
        """For each spring a row: by number of a spring that shares an end with it, the sum over shared ends of the
        weight times |cos(angle between them)|/mass."""
        masses = self.masses or {}
        inverse = {name: one.inverse for name, one in self.static_masses().items()}
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

        rows: list[dict[int, float]] = [{} for _ in self.springs]
        for k, spring in enumerate(self.springs):
            for name in spring.between:
                for other in at[name]:
                    share = weights[other] * (1.0 if other == k else cosine(k, other)) * inverse[name]
                    rows[k][other] = rows[k].get(other, 0.0) + share
        return rows
