"""Base class of all mass-spring models: pins, tearing, forces, outputs, shapes in pictures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import PrivateAttr

from sceneql import kinds
from sceneql.bodies import bodies as point_masses
from sceneql.bodies.filling.fill import chance_key, draws
from sceneql.bodies.nets import Net, faces_of
from sceneql.bodies.pins import Pin, guide, pinned, start_velocity
from sceneql.kinds import Gives, Model, Moment, Problem, Quantity, Record, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import suggestion
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly, Bodies, ModelState, Slopes

SPRINGS_A_TILE = 10_000
"""Springs of a tile, a task of one thread in the evaluation of the Jacobian."""
MOST_COILS = 40
ROPE_BEAD = 1.6
"""Radius of what holds a mass of a rope, over the rope's."""


class Tear(Record):
    """When springs break, for good: at the end of the solver's step in which one is stretched too far.

    Of at most 100 springs that step ends where this comes, if a tolerance chooses it and no contact is there.
    """

    at: kinds.FixedScalar = field("Its length then, as a part of its rest length.", "1.5", above=1)
    variation: kinds.FixedScalar = field(
        "Largest relative deviation of that from spring to spring.", "0", at_least=0, below=1
    )
    seed: int = field("Another number, other weak springs.", 0, at_least=0)


def pin_problems(pins: Iterable[str] | Mapping[str, Pin], known: Sequence[str], count: int | None) -> Iterator[Problem]:
    """Problems: pins that are neither a known name nor the number of one of ``count`` masses (None: not known yet)."""
    listed = () if isinstance(pins, Mapping) else tuple(pins)

    def place(pin: str) -> tuple[int | str, ...]:
        return ("pins", listed.index(pin)) if listed else ("pins", pin)

    for pin in pins:
        if isinstance(pins, Mapping) and pins[pin].where is not None:
            continue
        if pin not in known and not pin.isdecimal():
            text = f"no mass is called '{pin}'; a pin is one of {', '.join(sorted(known))}, or a number"
            near = suggestion("_".join(re.findall(r"[a-z]+", pin.lower())).replace("upper", "top"), known)
            every = ", ".join(one for one in known if "_" in one) or ", ".join(known[-2:])
            sided = [one for one in known if "corner" in pin.lower() and f"top_{_side(pin)}" == one]
            near = f"did you mean '{sided[0]}'?" if sided else near
            near = f"a list stands in brackets: write `pins: [{pin}]`" if "," in pin else near
            near = near or (f"write `pins: [{every}]`, or some of them" if len(known) > 1 else None)
            yield Problem(text, place(pin), at_key=True, help=near)
        elif pin not in known and count is not None and float(pin) >= count:
            yield Problem(f"pin {pin}: the {count} masses are counted from 0", place(pin), at_key=True)


def _side(pin: str) -> str:
    """The side that stands in a name of other programs, ``corner_left``; empty for none."""
    return next((side for side in ("left", "right") if side in pin.lower()), "")


class SpringModel(Model):
    """Point masses tied by springs."""

    immersible = True

    gives: ClassVar[Mapping[str, Gives]] = {
        **point_masses.BODY_OUTPUTS,
        "stretch": Gives(Type(), "Largest |L - L0| / L0 of a spring that holds.", computed=True),
        "springs": Gives(quantity_type(dim.LENGTH, (None, 2, 3)), "The two ends of every spring that holds."),
        "torn": Gives(Type(), "Number of springs that have torn.", computed=True),
        "triangles": Gives(
            Type((None, 3)), "Of a cloth or a solid: its surface by numbers of masses, less what tore.", computed=True
        ),
    }

    pins: tuple[str, ...] | dict[str, Pin] = field(
        "Masses that are held: names, or `name: {shift: ..., until: ...}`. Names are those of the masses; of a lattice "
        "left, right, bottom, top, back, front; of a cloth left, right, bottom, top and corners such as top_left; of a "
        "rope start, end; or a number, counted from 0; or any, with `where`.",
        (),
    )
    tear: Tear | None = field("When springs break; by default never.", None)
    velocity: kinds.FixedVelocity = field("Velocity of all at the start.", "0 0 0 m/s")
    spin: Annotated[tuple[float, float, float], Quantity(dim.FREQUENCY, (3,), turning=True)] = field(
        "Angular velocity at the start, about the center of mass [rad/s].", "0 0 0 rad/s"
    )
    radius: kinds.FixedLength | None = field(
        "Radius of the masses in contacts and in the picture; by default a tenth of the shortest spring.",
        None,
        at_least=0,
    )
    look: Literal["auto", "coil", "line", "masses"] = field(
        "How it draws itself: springs as coils or lines, or not at all; `auto`: coils when few, a cloth as a sheet, a "
        "solid as its surface, where no object shows them, and what holds masses as dark rails, plates and beads.",
        "auto",
    )
    material: kinds.MaterialRef | None = field("How it looks where no object draws it.", None)
    color: kinds.Color | None = field("Color in place of the material's.", None)

    _made: tuple[Net, Floats] | None = PrivateAttr(None)

    def make(self, assembly: Assembly) -> tuple[Net, Floats, Floats]:
        """The net at the start, the masses (n,) [kg], and the blocks (m, 5) of the springs.

        A block: rest length [m]; stiffness [N/m], plus a multiple of the model's; damping [N s/m], plus a multiple of
        the model's.
        """
        raise NotImplementedError

    def mass_count(self) -> int | None:
        """Number of masses, where the fields determine it."""
        return None

    def items(self, output: str) -> int | None:
        """Number of items of an output that has one a mass, where it is known; else None."""
        several = point_masses.BODY_OUTPUTS.get(output)
        return None if several is None or several.type.shape[:1] != (None,) else self.mass_count()

    def shared(self, assembly: Assembly) -> tuple[int, int]:
        """Offsets of the model's stiffness and damping in the floats."""
        return (assembly.floats([0.0]),) * 2

    def damped(self, blocks: Floats) -> bool:
        """Whether any spring may be damped."""
        return bool(blocks[:, 3].any())

    def start_velocities(self, count: int) -> Floats:
        """Initial velocities (n, 3) [m/s], without the spin."""
        import numpy as np

        return np.tile(self.velocity, (count, 1)).astype(float)

    def held(self, net: Net) -> Any:
        """Mask (n,) of the masses that are pinned at the start."""
        import numpy as np

        fixed = np.zeros(len(net.points), dtype=bool)
        for pin in self.pins:
            fixed[pinned(pin, net, self.pins[pin] if isinstance(self.pins, dict) else None)] = True
        return fixed

    @property
    def net(self) -> Net:
        """The network; available once the island is assembled."""
        assert self._made is not None
        return self._made[0]

    @property
    def single(self) -> dict[str, int]:
        """Numbers of the single masses by name: listed masses, a rope's ends, a cloth's corners."""
        import numpy as np

        found = {name: np.arange(len(self.net.points))[of].ravel() for name, of in self.net.places.items()}
        return {name: int(of[0]) for name, of in found.items() if len(of) == 1}

    @property
    def rest(self) -> Floats:
        """Rest lengths (m,) [m] of the springs."""
        assert self._made is not None
        return self._made[1]

    def burdens(self, density: float) -> bool:
        """Whether its weight may differ from that of displaced fluid of a density [kg/m^3]; true unless overridden."""
        return True

    def static_net(self) -> tuple[float, int] | None:
        """(spacing of the masses [m], number of axes along which they extend) if the fields determine it, else None."""
        return None

    def mass_radius(self) -> float:
        """Radius of the masses [m]: the given one, else a tenth of the shortest spring."""
        if self.radius is not None:
            return self.radius
        some = self.rest[self.rest > 0]
        return 0.1 * float(some.min()) if len(some) else 0.05

    def assemble(self, name: str, assembly: Assembly) -> Bodies:
        """Reserve the masses and add the forces of the springs."""
        import numpy as np

        from sceneql.system import Springs

        net, weights, blocks = self.make(assembly)
        self._made = (net, blocks[:, 0].copy())
        fixed = self.held(net)
        n, m = len(net.points), len(net.pairs)
        velocities = self.start_velocities(n)
        velocities += np.cross(self.spin, net.points - np.average(net.points, axis=0, weights=weights))
        velocities[fixed] = 0.0
        for pin, how in self.pins.items() if isinstance(self.pins, dict) else ():
            velocities[pinned(pin, net, how)] = start_velocity(how, assembly)
        stiffness_at, damping_at = self.shared(assembly)
        radii, flow = np.full(n, self.mass_radius()), assembly.carrier(name)
        if flow is None:
            bodies = point_masses.reserve(name, assembly, net.points, velocities, weights, radii, fixed)
        else:
            from sceneql.bodies.filling import displacing

            displacing.must_hold(self.pins, assembly)
            pull = float(((blocks[:, 1] + blocks[:, 2] * assembly.numbers()[stiffness_at]) * blocks[:, 0] ** 2).sum())
            bodies = displacing.reserve(name, assembly, net, velocities, weights, radii, fixed, pull, flow)
        blocks_at = assembly.floats(blocks.ravel())
        ends = net.pairs.ravel().tolist()
        places = (bodies.position_at, bodies.velocity_at, bodies.work_at)
        ints = (*places, blocks_at, stiffness_at, damping_at, m, *ends, bodies.inverse_at)
        damped = self.damped(blocks)
        assembly.term(
            "internal",
            "sceneql.bodies.mass_spring_kernels:springs",
            ints,
            lambda: _slopes(net, bodies, damped, ints[3:6]),
            energy="sceneql.bodies.mass_spring_energy_kernels:potential",
            damped=damped,
        )
        torn_at = assembly.floats([0.0, 0.0])
        if self.tear is not None:
            luck = draws(np.arange(m, dtype=np.uint64), 0, chance_key(name, self.tear.seed))
            strains = (self.tear.at - 1) * (1 + self.tear.variation * (2 * luck - 1))
            strains *= 1.0 if net.toughness is None else net.toughness
            more = (assembly.floats((1 + strains) * blocks[:, 0]), torn_at)
            torn = (bodies.position_at, bodies.work_at, blocks_at, stiffness_at, *more, m, *ends)
            assembly.after_step("sceneql.bodies.tear_kernels:tear", torn)
        if isinstance(self.pins, dict):
            guide(self.pins, net, assembly, bodies)
        assembly.remember(blocks_at, stiffness_at, torn_at)
        stiffnesses = blocks[:, 1] + blocks[:, 2] * assembly.numbers()[stiffness_at]
        period = _shortest_period(net.pairs, stiffnesses, weights)
        dampings = blocks[:, 3] + blocks[:, 4] * assembly.numbers()[damping_at]
        lasting = net.triangles is not None and self.tear is None
        faces = partial(faces_of, net, stiffnesses, self.mass_radius()) if lasting else None
        return replace(bodies, springs=Springs(net.pairs, np.stack([stiffnesses, dampings]), period, faces))

    def holding(self, state: ModelState) -> Any:
        """Mask (m,) of the springs that have not torn."""
        import numpy as np

        from sceneql.bodies.mass_spring_kernels import BLOCK

        m, at = len(self.net.pairs), state.ints[0]
        if self.tear is None:
            return np.ones(m, dtype=bool)
        return state.floats[at : at + BLOCK * m].reshape(m, BLOCK)[:, 1:3].any(axis=1)

    def read(self, output: str, state: ModelState) -> Any:
        """Value of an output of ``gives`` or of a single mass."""
        import numpy as np

        assert state.bodies is not None
        blocks_at, stiffness_at, torn_at = state.ints
        if output in point_masses.BODY_OUTPUTS:
            own = 0.0
            if output in ("potential", "energy"):
                from sceneql.bodies.mass_spring_energy_kernels import energy

                at = state.bodies.position_at
                own = energy(state.y, at, state.floats, blocks_at, stiffness_at, self.net.pairs)
            return point_masses.read(output, state.bodies, state, own)
        if output == "triangles":
            found = self.triangles(state)
            return np.zeros((0, 3)) if found is None else found.astype(float)
        if output == "torn":
            return float(state.floats[torn_at])
        holding = self.holding(state)
        ends = point_masses.positions(state.bodies, state)[self.net.pairs[holding]]
        if output == "springs":
            return ends
        if output == "stretch":
            lengths, rest = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), self.rest[holding]
            stretched = rest > 0
            return float(np.max(np.abs(lengths[stretched] / rest[stretched] - 1), initial=0.0))
        return point_masses.read_named(output, self.single, state.bodies, state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Indices in y of outputs of the masses, and of the ends of springs where no spring tears."""
        assert state.bodies is not None
        if output != "springs":
            found = point_masses.places(output, state.bodies)
            return point_masses.places_named(output, self.single, state.bodies) if found is None else found
        found = point_masses.places("positions", state.bodies)
        return None if found is None or self.tear is not None else found[self.net.pairs]

    def triangles(self, state: ModelState) -> Any:
        """Triangles (k, 3) of its surface without a torn side; None where it has no surface."""
        import numpy as np

        net = self.net
        if net.triangles is None or self.tear is None:
            return net.triangles
        if net.tetrahedra is not None:
            from sceneql.bodies.filling.tetrahedra import boundary

            return boundary(self.tetrahedra(state))
        n = len(net.points)
        torn = np.sort(net.pairs[~self.holding(state)], axis=1) @ [n, 1]
        sides = np.sort(net.triangles[:, [[0, 1], [1, 2], [2, 0]]].astype(np.int64), axis=2) @ [n, 1]
        return net.triangles[~np.isin(sides, torn).any(axis=1)]

    def tetrahedra(self, state: ModelState) -> Any:
        """Tetrahedra (t, 4) of a solid without a torn edge; none for other models."""
        import numpy as np

        from sceneql.bodies.filling.tetrahedra import edges

        net = self.net
        if net.tetrahedra is None:
            return np.zeros((0, 4), dtype=np.int32)
        if self.tear is None:
            return net.tetrahedra
        return net.tetrahedra[self.holding(state)[edges(net.tetrahedra)[1]].all(axis=1)]

    def asked_to_draw(self) -> bool:
        """Whether the script sets its look."""
        return self.look != "auto"

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Shape]:
        """Its shapes: a cloth as a sheet, a solid as its skin, else masses as spheres and springs as coils or lines.

        And what holds masses.
        """
        from sceneql.bodies import spring_look

        assert state.bodies is not None
        surface = moment.surface(name, self.material, self.color)
        places = point_masses.positions(state.bodies, state).copy()
        triangles = self.triangles(state)
        held, line = point_masses.held(state.bodies, state), self.net.line
        if self.look == "auto":
            bead = ROPE_BEAD * self.mass_radius() if line else self.mass_radius()
            yield from spring_look.holders(name, places, held, triangles, bead)
        if triangles is not None and self.look == "auto":
            yield spring_look.skin(name, surface, places, triangles, 0.5 * self.mass_radius())
            return
        shown = places[~held] if self.look == "auto" else places
        yield spring_look.spheres(name, surface, shown, self.mass_radius())
        holding = self.holding(state)
        ends, rest = places[self.net.pairs[holding]], self.rest[holding]
        if self.look == "coil" or (self.look == "auto" and len(self.net.pairs) <= MOST_COILS and not line):
            yield spring_look.coils(name, surface, ends, rest, self.mass_radius())
        elif self.look != "masses":
            yield spring_look.lines(name, surface, ends, self.mass_radius() if line else 0.15 * self.mass_radius())


def _shortest_period(pairs: Any, stiffnesses: Floats, weights: Floats) -> float:
    """Lower bound [s] of the periods of small oscillations, from w^2 <= max 2 (sum of a mass's stiffnesses) / mass.

    Gershgorin's theorem for K v = w^2 M v: a mass's row has this sum in its diagonal block and again off it.
    """
    import numpy as np

    sums = sum(np.bincount(pairs[:, end], np.abs(stiffnesses), len(weights)) for end in range(2))
    fastest = float(np.max(2.0 * sums / weights, initial=0.0))
    return 2.0 * np.pi / fastest**0.5 if fastest > 0.0 else np.inf


def _slopes(net: Net, bodies: Bodies, damped: bool, floats_at: Sequence[int]) -> Slopes:
    """Jacobian of the springs: for each spring one 3x3 block by positions, at the four pairs of its ends.

    If ``damped``, another block by velocities.
    """
    import numpy as np

    from sceneql.bodies.mass_spring_slopes_kernels import tile
    from sceneql.compiled.threads_kernels import threads, tile_address
    from sceneql.system import Slopes

    count = len(net.pairs)
    ends = 3 * net.pairs.astype(np.int64)
    rows = np.repeat(ends, 2, axis=1).ravel() + bodies.velocity_at
    columns = np.tile(ends, 2).ravel()
    by = [bodies.position_at, bodies.velocity_at] if damped else [bodies.position_at]
    own = np.arange(count * len(by)).reshape(-1, 1)
    tiles = count // SPRINGS_A_TILE + 1
    head = (bodies.position_at, bodies.velocity_at, bodies.inverse_at, count, int(damped), tiles)
    return Slopes(
        "sceneql.bodies.mass_spring_slopes_kernels:springs",
        np.tile(rows, len(by)),
        np.concatenate([columns + at for at in by]),
        np.concatenate([(*head, *threads(), tile_address(tile), *floats_at), net.pairs.ravel()]),
        np.concatenate([-1 - own, own, own, -1 - own], axis=1).ravel(),
        blocks=True,
        positive="sceneql.bodies.mass_spring_slopes_kernels:positive",
    )
