"""Assembly of a graph's island: its models, then its forces and contacts; whole, or in blocks of its bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, cast

from sceneql.bodies.bodies import diagonal
from sceneql.doing import doing
from sceneql.graph import Island, SimulationGraph, Task
from sceneql.island.island import IslandAssembly
from sceneql.island.system import System
from sceneql.kinds import Contact, Interaction, Model, Object, Ref, Solver, Tie, Value
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.expression import Expr, Link
from sceneql.system import Bodies, IslandFacts, ModelState, Stepper

BLOCK = 4608
"""Approximate number of bodies of a block: at some 300 bytes each they stay in a core's cache from step to step."""


@dataclass(frozen=True)
class Setting:
    """The part of the scene that an island's assembly reads."""

    tasks: Mapping[str, Task]
    end: float
    """End of the run [s]."""

    def object(self, ref: Ref) -> Object:
        """The kind of an object of the script, as written."""
        task = self.tasks[ref.name]
        return cast(Object, task.original or task.kind)

    def holder(self, ref: Ref) -> tuple[str, Object] | None:
        """The group, or other object of objects, that an object of the script is a member of, and its kind."""
        for name, task in self.tasks.items():
            members = getattr(task.kind, "members", None)
            if members is not None and any(one.name == ref.name for one in members()):
                return name, cast(Object, task.original or task.kind)
        return None

    def fluids(self, flow: str) -> tuple[tuple[float, float], ...]:
        """Density [kg/m^3] and viscosity [Pa s] of each other fluid that skins in a flow enclose."""
        found = [cast(Model, self.tasks[name].kind).fluid() for name, by in self._carriers.items() if by == flow]
        return tuple(one for one in found if one is not None)

    def carrier(self, model: str) -> str | None:
        """The name of the flow that carries a model; None where none does."""
        return self._carriers.get(model)

    def laden(self, flow: str) -> bool:
        """Whether masses carried by a flow add to its inertia or reduce it."""
        density = getattr(self.tasks[flow].kind, "density", 0.0)
        carried = [cast(Model, self.tasks[name].kind) for name, by in self._carriers.items() if by == flow]
        return any(model.burdens(density) for model in carried)

    @cached_property
    def _carriers(self) -> dict[str, str]:
        """The name of the flow, by the model that it carries."""
        kinds = [task.kind for task in self.tasks.values() if isinstance(task.kind, Interaction)]
        carried = [(name, flow.name) for kind in kinds if (flow := kind.carrier()) for name in kind.targets() or ()]
        return {name: flow for name, flow in carried if name in self.tasks}

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression: of a kinematic model, or an object's field.

        None where it stands in the state.
        """
        kind = self.tasks[link.task].kind
        if isinstance(kind, Model):
            return kind.formula(link.output) if kind.kinematic else kind.computed(link.task, link.output)
        value = getattr(kind, link.output, None)
        return value.expr if isinstance(value, Value) else None


@dataclass(frozen=True, slots=True)
class Assembled:
    """An island under construction and the bodies of its models."""

    graph: SimulationGraph
    island: Island
    assembly: IslandAssembly
    bodies: dict[str, Bodies | None] = field(default_factory=dict)
    found: Diagnostics = field(default_factory=Diagnostics)
    """The errors of its parts."""

    @contextmanager
    def word(self, name: str, model: str | None = None) -> Iterator[None]:
        """Context manager: what is added inside belongs to part ``name``.

        Its errors are collected, so that others are found too.
        """
        with self.assembly.word(name, self.graph.tasks[name].span, model):
            try:
                yield
            except ScriptError as error:
                self.found.extend(error.diagnostics)

    def places(self, link: Link) -> Any:
        """Indices into the state of an output of one of the models (Model.places), for values read at stage times."""
        state = self._at_start(link.task)
        return None if state is None else cast(Model, self.graph.tasks[link.task].kind).places(link.output, state)

    def points(self, link: Link) -> Any:
        """The bodies of a link to a position, the number of one, and the point on it (Model.point), for forces."""
        state = self._at_start(link.task)
        if state is None or state.bodies is None:
            return None
        found = cast(Model, self.graph.tasks[link.task].kind).point(link.output, state)
        return None if found is None else (state.bodies, *found)

    def _at_start(self, name: str) -> ModelState | None:
        """The state of one of the models at the start; None for other parts, or before it is assembled."""
        if name not in self.bodies:
            return None
        start, ints = self.assembly.start(), self.assembly.remembered(name)
        return ModelState(0.0, start, start, self.assembly.numbers(), self.bodies[name], ints)

    def facts(self) -> IslandFacts:
        """The facts by which a solver chooses its methods; call it once forces and contacts are added."""
        made = self.assembly
        forces = [cast(Interaction, self.graph.tasks[force].kind) for force, _ in self.island.forces]
        turning = all(one is not None and one.turning is not None for one in self.bodies.values())
        solids = [one for one in self.bodies.values() if one is not None and one.skin is not None]
        return IslandFacts(
            entries=len(made.start()),
            local_contacts="local" in made.contact_mode,
            impacts=made.changed_between_steps,
            fields=made.on_grids,
            floats=made.numbers,
            orbits=bool(forces) and made.moved_by_forces_alone and all(force.at_a_distance() for force in forces),
            free=made.moves_freely and turning and all(force.uniform() for force in forces),
            apart="barrier" in made.contact_mode,
            in_solids=sum(3 * one.count for one in solids),
            solids_size=min((diagonal(one, made.start()) for one in solids), default=1.0),
        )

    def act(self) -> None:
        """Add the forces and contacts."""
        tasks = self.graph.tasks
        forces = dict.fromkeys(force for force, _ in self.island.forces)
        # Masses that a flow carries come first: skins need the flow's inertia, which includes these masses.
        for force in [force for force in forces if cast(Interaction, tasks[force].kind).carrier()]:
            self._add_to_masses(force)
        for force in forces:
            self._add_force(force)
        if self.assembly.ties:
            from sceneql.bodies.rigid.tie_system import add_ties

            with self.word(next(name for name, _ in self.island.forces if isinstance(tasks[name].kind, Tie))):
                add_ties(self.assembly, self.assembly.ties)
        self.assembly.begin_contacts()
        contacts = dict.fromkeys(contact for contact, _, _ in self.island.contacts)
        # Contacts between masses come last: those with objects need the path of the whole step as the solver made it.
        for contact in sorted(contacts, key=lambda name: cast(Contact, tasks[name].kind).mutual):
            self._add_contact(contact)
        if any(tie.drive for tie in self.assembly.ties) and not self.assembly.driven and not self.found.errors:
            from sceneql.bodies.rigid.tied_step import add_bounded_step
            from sceneql.contacts.rigid_exact.group import assemble_drives

            name = next(tie.name for tie in self.assembly.ties if tie.drive)
            with self.word(name):
                if self.island.contacts or not assemble_drives(self.assembly):
                    add_bounded_step(self.assembly)

    def _add_force(self, force: str) -> None:
        """Add a force on the masses of all its models, on skins and on fluids."""
        task = self.graph.tasks[force]
        kind = cast(Interaction, task.kind)
        for model in [model for name, model in self.island.forces if name == force] if kind.carrier() else ():
            with self.word(force, model):
                kind.assemble_carried(force, self.assembly, model)
        filled = [model for name, model in self.island.forces if name == force and kind.weighs]
        if any(cast(Model, self.graph.tasks[model].kind).fluid() is not None for model in filled):
            with self.word(force):
                kind.assemble_weight(force, self.assembly)
        everyone = [self.bodies.get(model) for name, model in self.island.forces if name == force]
        masses = [bodies for bodies in everyone if bodies is not None]
        if kind.mutual and masses:
            with self.word(force):
                kind.assemble_together(force, self.assembly, masses)
        if not kind.mutual and not kind.carrier():
            self._add_to_masses(force)

    def _add_to_masses(self, force: str) -> None:
        """Add a force on the masses of each of its models."""
        kind = cast(Interaction, self.graph.tasks[force].kind)
        for model in [model for name, model in self.island.forces if name == force]:
            bodies = self.bodies.get(model)
            if bodies is not None:
                with self.word(force, model):
                    kind.assemble(force, self.assembly, bodies)

    def _add_contact(self, contact: str) -> None:
        """Add a contact of the masses of all its models with its objects."""
        task = self.graph.tasks[contact]
        kind = cast(Contact, task.kind)
        rows = [(self.bodies.get(model), others) for name, model, others in self.island.contacts if name == contact]
        found = [(bodies, tuple(Ref(other) for other in others)) for bodies, others in rows if bodies is not None]
        masses = [(bodies, refs) for bodies, refs in found if bodies.immersed is None]
        with self.word(contact):
            if kind.mutual and masses:
                kind.assemble_together(contact, self.assembly, [bodies for bodies, _ in masses], masses[0][1])
            elif any(bodies.skin is not None for bodies, _ in masses):
                everyone = [bodies for bodies, _ in masses]
                if kind.assemble_skins(contact, self.assembly, everyone, masses[0][1]):
                    return
            rigid = [(bodies, refs) for bodies, refs in masses if bodies.turning is not None]
            if rigid and not kind.mutual:
                kind.assemble_rigid(contact, self.assembly, [bodies for bodies, _ in masses], rigid[0][1])
            for bodies, refs in masses if not kind.mutual and not rigid else ():
                kind.assemble(contact, self.assembly, bodies, refs)
        self._add_carried(contact, kind, [bodies for bodies, _ in masses])

    def _add_carried(self, contact: str, kind: Contact, everyone: Sequence[Bodies]) -> None:
        """Add a contact of skins and masses that a flow carries, with its objects and other masses."""
        rows = [(model, others) for name, model, others in self.island.contacts if name == contact]
        rows = [row for row in rows if self.assembly.carrier(row[0]) is not None]
        carried = [bodies for model, _ in rows if (bodies := self.bodies.get(model)) is not None]
        with self.word(contact):
            if rows:
                touched = tuple(Ref(other) for other in rows[0][1])
                skins = [model for model, _ in rows if model not in {bodies.model for bodies in carried}]
                kind.assemble_carried(contact, self.assembly, skins, carried, everyone, touched)


def models_of(graph: SimulationGraph, island: Island, marched: bool = True) -> Assembled:
    """An island with its models, without forces and contacts yet; ``marched``: as in Assembly."""
    made = Assembled(graph, island, IslandAssembly(Setting(graph.tasks, graph.settings.clock.end)))
    stepper = cast(Solver, graph.tasks[island.solver].kind).stepper()
    made.assembly.by_tolerance = stepper.control.adaptive and not (stepper.needs.jacobian or stepper.needs.march)
    made.assembly.marched = marched
    setting = made.assembly.setting
    for name in sorted(island.models, key=lambda name: setting.carrier(name) is not None):
        with made.word(name), doing(f"making {name}"):
            made.bodies[name] = cast(Model, graph.tasks[name].kind).assemble(name, made.assembly)
    for name in island.models:
        with made.word(name):
            cast(Model, graph.tasks[name].kind).connect(name, made.assembly)
    made.assembly.places, made.assembly.points = made.places, made.points
    return made


@dataclass(frozen=True, slots=True)
class Block:
    """A block: some bodies of an island, as an island of their own."""

    system: System
    places: tuple[tuple[int, int, int], ...]
    """(offset in the island's state, offset in the block's, count) of its entries, without tallies."""
    sums: tuple[tuple[int, int], ...]
    """(index in the island's state, index in the block's) of tallies, which are sums over the bodies."""
    assembly: IslandAssembly
    changes: tuple[tuple[int, int, int], ...]
    """As ``places``, for the floats that change as bodies come and go."""


def blocks_of(whole: Assembled, system: System, stepper: Stepper) -> list[Block]:
    """The island divided into blocks that fit into a cache; empty where bodies interact or steps are adaptive."""
    count = sum(0 if bodies is None else bodies.count for bodies in whole.bodies.values()) // BLOCK
    needs = stepper.needs
    fixed = not stepper.control.adaptive and not needs.jacobian and needs.prepare is None
    if count < 2 or not fixed or not whole.assembly.apart:
        return []
    made = [_block(whole, system, k, count) for k in range(count)]
    return [block for block in made if block is not None] if None not in made else []


def _block(whole: Assembled, system: System, number: int, count: int) -> Block | None:
    """Block ``number`` of ``count``: an equal part of every model; None where one cannot be divided."""
    graph, island = whole.graph, whole.island
    made = Assembled(graph, island, IslandAssembly(whole.assembly.setting, whole.assembly.body_count()))
    places, sums, changes = [], [], []
    for name, bodies in whole.bodies.items():
        if bodies is None:
            return None
        first, last = (bodies.count * k // count for k in (number, number + 1))
        start = ModelState(0.0, system.y, system.y, system.floats, bodies, whole.assembly.remembered(name))
        with made.word(name):
            part = cast(Model, graph.tasks[name].kind).assemble_part(name, made.assembly, bodies, start, first, last)
        if part is None:
            return None
        made.bodies[name] = part
        for there, here in ((bodies.position_at, part.position_at), (bodies.velocity_at, part.velocity_at)):
            places.append((there + 3 * first, here, 3 * (last - first)))
        sums.append((bodies.work_at, part.work_at))
        for there, here in zip(_numbers_of(bodies), _numbers_of(part), strict=True):
            changes.append((there + first, here, last - first))
    made.act()
    made.found.raise_errors()
    for (there, n), (here, _) in zip(whole.assembly.changes, made.assembly.changes, strict=True):
        changes.append((there, here, n))
    changing = tuple(changes) if whole.assembly.changes else ()
    return Block(made.assembly.finish(), tuple(places), tuple(sums), made.assembly, changing)


def _numbers_of(bodies: Bodies) -> tuple[int, int, int]:
    return bodies.mass_at, bodies.inverse_at, bodies.radius_at
