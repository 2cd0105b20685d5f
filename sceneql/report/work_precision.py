"""Running one island by one solver setting after another: what error is left at the end, and what it costs."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Solver

if TYPE_CHECKING:
    from sceneql.simulation.run import Instant, IslandRun

STEPS = tuple(2**k for k in range(4, 19))
"""Steps of a fixed-step run, until ENOUGH_SECONDS or the reference's own error is reached."""
TOLERANCES = tuple(10.0**-k for k in range(2, 14))
REPEATS = 5
ENOUGH_SECONDS = 0.5
"""No step smaller than one that takes so long is tried, and no run is repeated that has taken so long in all."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """One run of an island."""

    island: str
    solver: str
    adaptive: bool
    setting: float
    """Step [s], or relative tolerance."""
    outcome: str
    """``ok``, or why the run failed."""
    error: float
    """Relative error at the end; NaN where the run failed."""
    seconds: float
    """Median run time of the compiled steps, compilation left out; NaN where the run failed."""
    steps: int
    evaluations: int
    """Evaluations of dy/dt."""

    @property
    def ok(self) -> bool:
        """Whether the run reached its end."""
        return self.outcome == "ok"


@dataclass(frozen=True, slots=True)
class Reference:
    """What the end of a run is compared with."""

    error: Callable[[Instant, IslandRun], float]
    """Relative error of a run that has reached the end."""
    because: str
    uncertainty: float
    """Relative error of the reference itself."""


def solvers(graph: SimulationGraph, island: Island, catalogue: Catalogue) -> dict[str, Solver]:
    """The solvers that can march an island: those that need nothing but a step or a tolerance, and the script's own.

    `auto` is no method of its own; neither is a word whose steps are those of another.
    """
    found: dict[str, Solver] = {}
    for word in catalogue.words("solvers"):
        cls = catalogue.load("solvers", word)
        if word != "auto" and cls is not None and not any(info.is_required() for info in cls.model_fields.values()):
            found[word] = cast(Solver, cls.model_validate({}))
    own = graph.tasks[island.solver]
    found.setdefault(own.word, cast(Solver, own.kind))
    kept: dict[str, Solver] = {}
    for word, solver in found.items():
        if all(at(solver, 1e-3).stepper() != at(other, 1e-3).stepper() for other in kept.values()):
            kept[word] = solver
    return kept


def at(solver: Solver, setting: float) -> Solver:
    """The same solver with another step [s] or tolerance."""
    return solver.model_copy(update={"tolerance" if _adaptive(solver) else "step": setting})


def run(graph: SimulationGraph, island: Island, solver: Solver) -> tuple[Instant, IslandRun]:
    """An island's run by a solver, at its end. Raises RunFailure."""
    from sceneql.simulation.run import Run

    task = replace(graph.tasks[island.solver], kind=solver)
    prepared = Run(replace(graph, tasks={**graph.tasks, island.solver: task}, islands=(island,)))
    (end,) = prepared.moments([graph.settings.clock.end])
    return end, prepared.islands[0]


def measurements(
    graph: SimulationGraph, island: Island, word: str, solver: Solver, reference: Reference
) -> Iterator[Measurement]:
    """Runs of one solver from coarse to fine, until its error is the reference's own or the runs take long."""
    adaptive = _adaptive(solver)
    end = graph.settings.clock.end
    for setting in TOLERANCES if adaptive else [end / steps for steps in STEPS]:
        found = _measure(graph, island, word, at(solver, setting), setting, reference)
        yield found
        if found.error <= reference.uncertainty or found.seconds > ENOUGH_SECONDS:
            return


def _measure(
    graph: SimulationGraph, island: Island, word: str, solver: Solver, setting: float, reference: Reference
) -> Measurement:
    title = ", ".join(island.models)
    adaptive = _adaptive(solver)
    times: list[float] = []
    try:
        while len(times) < REPEATS and sum(times) < ENOUGH_SECONDS:
            moment, march = run(graph, island, solver)
            times.append(march.march.statistics.seconds)
    except RunFailure as failure:
        return Measurement(title, word, adaptive, setting, failure.diagnostic.message, math.nan, math.nan, 0, 0)
    done = march.march.statistics
    error = reference.error(moment, march)
    return Measurement(
        title, word, adaptive, setting, "ok", error, statistics.median(times), done.steps, done.evaluations
    )


def warm(graph: SimulationGraph, island: Island, solver: Solver) -> float:
    """Compile all that a run needs, before it is timed; the seconds that took."""
    from sceneql.kernels import compiled

    before = compiled.seconds
    with suppress(RunFailure):  # what fails has been compiled too
        run(graph, island, at(solver, TOLERANCES[0] if _adaptive(solver) else graph.settings.clock.end / STEPS[0]))
    return compiled.seconds - before


def _adaptive(solver: Solver) -> bool:
    return solver.stepper().adaptive
