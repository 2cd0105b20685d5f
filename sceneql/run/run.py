"""A run: the islands of a graph march, and the requested moments are read off, in one pass."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.doing import doing
from sceneql.failure import GivesWay, LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Interaction, Model, Object, Solver, Tie, Value
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.run.diverging import Diverged
from sceneql.run.dry_run import DryRun, asked, dry_run
from sceneql.run.grounded import grounded
from sceneql.run.hardly_seen import hardly_seen
from sceneql.run.history import History
from sceneql.run.instant import Instant
from sceneql.run.leaving import Leaving, warning
from sceneql.run.ranges import ranged
from sceneql.run.supports import Support, supports

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.march.assembled import Block
    from sceneql.march.march import March
    from sceneql.system import ModelState, Stepper


class Run:
    """One run of a graph. ``moments`` may be called once; its moments are valid until the next one is asked for.

    Raises ScriptError with all errors of building its islands. Without ``marching`` there are no islands. A run
    ``ahead`` of the film knows of the whole run only the present.
    """

    def __init__(self, graph: SimulationGraph, *, marching: bool = True, ahead: bool = False) -> None:
        if marching:
            graph = grounded(graph, lambda: Run(graph, marching=False).at(0.0))
        self.graph, self.ahead = graph, ahead
        found = Diagnostics()
        islands = graph.islands if marching else ()
        self.islands = [run for island in islands if (run := _built(graph, island, found)) is not None]
        found.raise_errors()
        self.island_of = {name: run for run in self.islands for name in run.members}
        self.orders = _orders(graph)
        self.palette = _palette(graph)
        self.holders = _holders(graph)
        self.history = History(graph.tasks.values() if marching else ())
        self._ranged = ranged(graph, islands)
        self._let_go: Sequence[Leaving] = ()
        self.diverged: Sequence[Diverged] = ()
        self._framed = False
        self._window: float | None = math.inf
        self._dry_runs: dict[str | None, DryRun] = {}
        self.kept: dict[str, tuple[Hashable, Any]] = {}
        """By part the key and the result of the latest `Instant.kept`."""

    def moments(self, times: Iterable[float]) -> Iterator[Instant]:
        """The instants [s] asked for, in order; times do not decrease. Raises RunFailure."""
        return map(self.at, times)

    def at(self, time: float) -> Instant:
        """The next instant [s]; times do not decrease. Raises RunFailure."""
        end = self.graph.settings.clock.end
        with doing(f"running to {time:.4g} s, {100 * time / end:.0f} % of the clock"):
            for before, keys in self.history.due(time):
                self.history.see(self._moment(before), keys)
            return self._moment(time)

    def _moment(self, time: float) -> Instant:
        for island in self.islands:
            island.advance(time)
        moment = Instant(self, time)
        for one in self._ranged:
            one.check(moment)
        return moment

    def state(self, name: str) -> ModelState:
        """The latest state of a model that is solved, of a contact, or of a tie."""
        return self.island_of[name].state(name)

    @cached_property
    def supports(self) -> Sequence[Support]:
        """What holds bodies to the world."""
        return supports(self.graph, lambda: Run(self.graph, marching=False).at(0.0))

    def boxes(self) -> Mapping[str, tuple[Floats, Floats]]:
        """Low and high corner (3,) [m] of each part over the whole run."""
        return self._bounded().bounds or {}

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats] | None:
        """Low and high corner (3,) [m] of what the parts draw over the whole run; None where nothing is drawn.

        Without names: of all that is drawn, except what leaves for good.
        """
        named, seen = list(names), self._bounded()
        if not named and seen.staying is not None:
            return seen.staying
        known = seen.bounds or {}
        corners = [known[name] for name in named or self.orders if name in known]
        if not corners:
            return None
        lows, highs = np.array([low for low, _ in corners]), np.array([high for _, high in corners])
        return lows.min(axis=0), highs.max(axis=0)

    def outline(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that is drawn and stays, over the whole run."""
        seen = self._bounded()
        self._let_go, self._framed = seen.leaving, True
        if seen.staying is not None:
            return np.array(list(product(*zip(*seen.staying, strict=True))))
        return np.concatenate(
            [np.zeros((0, 3)), *(seen.outlines[name] for name in self.orders if name in seen.outlines)]
        )

    def standing(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that is drawn and does not change."""
        seen = self._bounded()
        still = [points for name, points in seen.outlines.items() if name not in seen.changing]
        found = np.concatenate([np.zeros((0, 3)), *still])
        return found if seen.staying is None else np.clip(found, *seen.staying)

    def moving(self, window: float | None) -> Floats:
        """Instants [s] of the run, and points (n, 1 + 3) whose hull at each encloses all that may change and stays.

        ``window``: for how long at once a camera shows it [s], with all that stands; None: a camera shows it alone.
        """
        seen, self._window = self._bounded(), window
        rows = [np.column_stack([np.full(len(points), time), points]) for time, points in seen.moving]
        found = np.concatenate([np.zeros((0, 4)), *rows])
        if seen.staying is not None:
            low, high = seen.staying
            found = found[((found[:, 1:] >= low) & (found[:, 1:] <= high)).all(axis=1)]
        return found

    def warnings(self) -> tuple[Diagnostic, ...]:
        """Warnings of things that leave for good, where a camera let them go, and of what is small where it stood."""
        window = self._window if self._framed else None
        small = () if window is None else hardly_seen(self._bounded(), self.graph, window)
        return (*(warning(one, self.graph.tasks) for one in self._let_go), *small)

    def _bounded(self) -> DryRun:
        """The dry run ahead of this run, with bounds; made once."""
        if None not in self._dry_runs or self._dry_runs[None].bounds is None:
            self._dry_runs[None] = dry_run(Run(self.graph, ahead=True))
        return self._dry_runs[None]

    def course(self, value: Value, variant: str | None, until: float) -> tuple[Floats, Floats]:
        """Times (n,) [s] and a requested value at each (n, ...), up to an instant, in a variant of the script."""
        ahead, mine = self._dry_run(variant), value
        if variant is not None:
            key = next(key for key, one in asked(self.graph).items() if one is value)
            mine = asked(self.graph.variant(variant))[key]
        return ahead.course(mine.expr, until)

    def _dry_run(self, variant: str | None) -> DryRun:
        """The dry run of the script or of a variant of it; made once."""
        if variant not in self._dry_runs:
            graph = self.graph if variant is None else self.graph.variant(variant)
            self._dry_runs[variant] = dry_run(Run(graph, ahead=True), bounded=False)
        return self._dry_runs[variant]


class IslandRun:
    """An island in a run: its assembly, its march and its latest state."""

    def __init__(self, graph: SimulationGraph, island: Island) -> None:
        from sceneql.compiled.compile_beside import compile_beside

        compile_beside(("sceneql.march.march_kernels",))  # while the models are made here
        self.graph, self.island = graph, island
        ties = (name for name, _ in island.forces if isinstance(graph.tasks[name].kind, Tie))
        self.members = {*island.models, *(contact for contact, _, _ in island.contacts), *ties}
        self._now: tuple[float, Floats, Floats] | None = None
        self.notes: list[Diagnostic] = []
        """Warnings collected during the run."""
        self._make({})

    def _make(self, went_on: Mapping[str, ModelState], before: March | None = None, kept: int = 0) -> None:
        """Assemble the island and its march.

        ``before``: a march whose end this one continues; its first ``kept`` floats are taken over. ``went_on``: as in
        Assembly.
        """
        from sceneql.compiled.compile_beside import compile_beside
        from sceneql.compiled.numba import lazy_kernels
        from sceneql.march.assembled import blocks_of, models_of

        graph, island = self.graph, self.island
        solver = cast(Solver, graph.tasks[island.solver].kind)
        made = models_of(graph, island)
        made.assembly.went_on = went_on
        self.bodies = made.bodies
        self.assembly = made.assembly
        if not self.assembly.fields and not island.contacts:  # the solver's step is known before forces are added
            compile_beside((solver.stepper().method.step.partition(":")[0],))
        made.act()
        made.found.raise_errors()
        self.methods = solver.choose(made.facts())
        self.solver = self.methods.solver
        system = self._compiled(self.methods.first)
        compile_beside(lazy_kernels.modules())  # in the background: kernels that may never be called
        blocks = blocks_of(made, system, self.methods.first)
        try:
            self.march = self._marched(system, blocks, before, kept)
        except LimitRefused as refused:
            raise refused.at(graph.tasks[island.solver].span) from None

    def _go_on(self, why: GivesWay) -> None:
        """Assemble the island anew where a contact gives way, and continue from there.

        Raises ``why`` if that is impossible.
        """
        from sceneql.system import ModelState

        march, assembly = self.march, self.assembly
        at = march.stopped()
        states = {
            name: ModelState(at.time, at.y, at.rate, at.floats, None, assembly.remembered(name))
            for name in dict.fromkeys(contact for contact, _, _ in self.island.contacts) or (why.part,)
        }
        kept = assembly.before_contacts
        self._make(states, march, kept)
        if self.assembly.before_contacts != kept or len(self.march.system.y) > len(at.y):
            raise why
        name = why.part if why.part in states else next(iter(states))
        mode = self.assembly.contact_mode
        message = f"at {at.time:.6g} s, {name}: contacts go on in mode `{mode}`: {why.message}"
        help = "from there on places are of order 1 in the step; `mode: exact` ends the run there"
        self.notes.append(Diagnostic("gave-way", message, self.graph.tasks[name].span, help, severity="warning"))

    def _compiled(self, stepper: Stepper) -> System:
        """The island laid out for a method, after the kernels of both are compiled."""
        from sceneql.compiled.compile_beside import compile_beside
        from sceneql.compiled.generated import function
        from sceneql.island.jacobian import BY_DIFFERENCES
        from sceneql.linear.stage import likely_kernels
        from sceneql.march.driver import driver, jacobian, lazy_first, modules, own_modules

        method, needs = stepper.method, stepper.needs
        compile_beside(needs.beside)
        # Few masses under error control are followed from impact to impact.
        within = needs.newton and (not stepper.control.adaptive or len(self.assembly.start()) > BY_DIFFERENCES)
        system = self.assembly.finish(needs.jacobian, within)
        events = ("sceneql.march.events_kernels",) if system.pairs else ()
        likely = likely_kernels if needs.likely is None else function(needs.likely)
        solving = (method.step.partition(":")[0], *likely(system))
        read = needs.jacobian or not system.structure.local
        dense = (method.dense.partition(":")[0],) if method.dense is not None and read else ()
        drives = own_modules(system.structure) if needs.march is None else ()
        scales = ("sceneql.stepping.error_scales_kernels",) if stepper.control.by_scale else ()
        acting = compile_beside((*solving, *drives, *scales, *modules(system.structure), *events, *dense))
        acting(*solving)
        compile_beside(lazy_first(system.structure))
        if needs.march is None:  # meanwhile the second process compiles the solver
            driver(system)
            if needs.jacobian:
                jacobian(system)
        acting()
        return system

    def _marched(self, system: System, blocks: Sequence[Block], before: March | None, kept: int) -> March:
        """The march of the island: the method's own class, or BlockMarch, or March."""
        from sceneql.compiled.generated import function
        from sceneql.march.march import March

        stepper, end = self.methods.first, self.graph.settings.clock.end
        if stepper.needs.march is not None:
            own: March = function(stepper.needs.march)(system, stepper, end)
            return own
        if blocks:
            from sceneql.march.march_blocks import BlockMarch

            return BlockMarch(system, stepper, end, blocks)
        return March(
            system,
            stepper,
            end,
            stiff=self.methods.stiff,
            stiff_cost=self.methods.stiff_cost,
            otherwise=self.methods.otherwise,
            with_jacobian=None if stepper.needs.jacobian else lambda: self.assembly.finish(jacobian=True),
            before=before,
            kept=kept,
        )

    def advance(self, time: float) -> None:
        """March to an instant [s]. Raises RunFailure."""
        try:
            try:
                y, rate = self.march.advance(time)
            except GivesWay as why:
                self._go_on(why)
                y, rate = self.march.advance(time)
        except RunFailure as failure:
            raise self._explained(failure) from failure
        self._now = (time, y, rate)

    def _explained(self, failure: RunFailure) -> RunFailure:
        """The failure, with the trouble of a model in the last good state as its help, where it has none."""
        from sceneql.system import ModelState

        if type(failure) is not RunFailure or failure.help or not hasattr(self.march, "stopped"):
            return failure
        at = self.march.stopped()
        for name, bodies in self.bodies.items():
            state = ModelState(at.time, at.y, at.rate, at.floats, bodies, self.assembly.remembered(name))
            text, help = cast(Model, self.graph.tasks[name].kind).trouble(state)
            if help:
                return failure.helped(f"'{name}': {text}; {help}")
        return failure

    @property
    def y(self) -> Floats:
        """(n,) its state at the latest instant."""
        if self._now is None:
            raise RuntimeError("the island has not been marched yet")
        return self._now[1]

    def state(self, name: str) -> ModelState:
        """The state at the latest instant as a model, contact or tie sees it."""
        from dataclasses import replace

        from sceneql.system import ModelState

        if self._now is None:
            raise RuntimeError("the island has not been marched yet")
        time, y, rate = self._now
        floats = self.march.floats_at(time, y)
        bodies = self.bodies.get(name)
        if name not in self.bodies:
            memory, ints = self.march.memory(name, self.assembly, time, y)
            return ModelState(time, y, rate, memory, None, ints)
        state = ModelState(time, y, rate, floats, bodies, self.assembly.remembered(name))
        if bodies is None:
            return state
        potential = 0.0
        for force, model in self.island.forces:
            if model == name:
                kind = cast(Interaction, self.graph.tasks[force].kind)
                view = replace(state, ints=self.assembly.remembered(force, None if kind.mutual else model))
                potential += kind.potential(bodies, view)
        return replace(state, potential=potential)


def _built(graph: SimulationGraph, island: Island, found: Diagnostics) -> IslandRun | None:
    try:
        return IslandRun(graph, island)
    except ScriptError as error:
        found.extend(error.diagnostics)
        return None


def _orders(graph: SimulationGraph) -> dict[str, int]:
    """The parts that any picture draws, with their order."""
    return {name: k for k, name in enumerate(dict.fromkeys(name for of in graph.cameras for name in graph.drawn[of]))}


def _holders(graph: SimulationGraph) -> dict[str, str]:
    """For every object inside another one, the name of the (first) object that draws it."""
    objects = [(name, task.kind) for name, task in graph.tasks.items() if isinstance(task.kind, Object)]
    return {ref.name: name for name, kind in reversed(objects) for ref in kind.members()}


def _palette(graph: SimulationGraph) -> dict[str, int]:
    """Index of every object and model in the list of default colors, by the script's order before pruning."""
    return {name: k for k, name in enumerate(graph.palette)}
