"""Work-precision runs of an island: the error at the end and the run time, for a series of solver settings."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.passes.islands import pivots
from sceneql.failure import RunFailure, Unsuitable
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Model, Solver, Tie
from sceneql.quantities.diagnostic import suggestion
from sceneql.system import IslandFacts

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.run.instant import Instant
    from sceneql.run.run import IslandRun

STEPS = tuple(2**k for k in range(4, 19))
"""Numbers of steps of fixed-step runs, until a run takes ENOUGH_SECONDS or reaches the reference's own error."""
TOLERANCES = tuple(10.0**-k for k in range(2, 14))
TOLERANCE = 1e-6
"""Tolerance where the script's own solver has none."""
REPEATS = 5
ENOUGH_SECONDS = 0.5
"""Time of a run [s] after which no smaller step is tried, and of all repeats of a run."""
LONGEST = 20.0
"""Time of compiled steps [s] after which a run is given up."""
LOOKS = 128
"""Number of instants at which states are recorded for the ranges of quantities."""
FIRST_LOOK, NEXT_LOOK = 1e-9, 1.25
"""Fraction of a run after which its time is first checked, and the factor to each further check."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """One run of an island."""

    island: str
    solver: str
    adaptive: bool
    setting: float
    """Step [s], or relative tolerance."""
    outcome: str
    """``ok``, or the reason why the run failed."""
    error: float
    """Relative error at the end; NaN where the run failed."""
    seconds: float
    """Least run time [s] of the compiled steps over all repeats, without compilation; NaN where the run failed."""
    steps: int
    evaluations: int
    """Evaluations of dy/dt."""
    worst: str = ""
    """Description of the quantity with that error."""
    median: float = math.nan
    """Median run time of the repeats [s]."""

    @property
    def ok(self) -> bool:
        """Whether the run reached its end."""
        return self.outcome == "ok"


@dataclass(frozen=True, slots=True)
class Reference:
    """The reference with which the ends of runs are compared."""

    error: Callable[[Instant, IslandRun], float]
    """Relative error of a run that has reached the end."""
    because: str
    uncertainty: float
    """Relative error of the reference itself."""
    worst: Callable[[Instant, IslandRun], str] = lambda moment, march: ""
    """The quantity with that error."""
    damped: Callable[[IslandRun, Sequence[tuple[float, Floats]]], str] = lambda march, looks: ""
    """Function of a run and its states at instants [s]: text on a quantity at rest that still moves in the reference;
    or ""."""


class TooLong(RunFailure):
    """A run that was given up because of its run time."""


def solvers(graph: SimulationGraph, island: Island, catalogue: Catalogue) -> dict[str, Solver]:
    """The solvers that can march an island, at the script's step or tolerance.

    These are the words that require no other field, and the script's own. Of words with equal methods only one is kept,
    `auto` only if no other has them.
    """
    step, tolerance = settings(graph, island)
    given = {"step": step, "tolerance": tolerance}
    own = graph.tasks[island.solver]
    models = [cast(Model, graph.tasks[name].kind) for name in island.models]
    suits = {"anything", *(["a flow"] if any(model.flows for model in models) else [])}
    suits |= {"a field"} if [model.field_count() for model in models] == [1] else set()
    ties = [name for name, _ in island.forces if isinstance(graph.tasks[name].kind, Tie)]
    bound = not pivots(list(dict.fromkeys(ties)), graph.tasks)
    found: dict[str, Solver] = {own.word: cast(Solver, own.kind)}
    for word in catalogue.words("solvers"):
        cls = cast("type[Solver] | None", catalogue.load("solvers", word))
        if cls is None or word in found or cls.marches not in suits or cls.static or (cls.refuses_ties and bound):
            continue
        needed = {name for name, info in cls.model_fields.items() if info.is_required()}
        if needed <= set(given):
            solver = cls.model_validate({name: given[name] for name in needed})
            found[word] = at(solver, given["tolerance" if adaptive(solver) else "step"])
    kept: dict[str, Solver] = {}
    for word in sorted(found, key=lambda word: (word == "auto", word)):
        methods = at(found[word], 1e-3).choose(IslandFacts())
        if all(methods != at(other, 1e-3).choose(IslandFacts()) for other in kept.values()):
            kept[word] = found[word]
    return kept


def known(chosen: Sequence[str], catalogue: Catalogue) -> None:
    """Raises Unsuitable for a word that is no solver."""
    words = catalogue.words("solvers")
    for word in chosen:
        if word not in words:
            hint = suggestion(word, words) or f"there are {', '.join(words)}"
            raise Unsuitable(f"there is no solver '{word}': {hint}")


def among(chosen: Sequence[str], applying: dict[str, dict[str, Solver]]) -> dict[str, dict[str, Solver]]:
    """By the islands' titles, the chosen solvers, or all where none is chosen. Raises Unsuitable where none applies."""
    kept = {
        title: {word: solver for word, solver in found.items() if word in chosen or not chosen}
        for title, found in applying.items()
    }
    if chosen and not any(kept.values()):
        there = "; ".join(f"{title}: {', '.join(found)}" for title, found in applying.items())
        raise Unsuitable(f"none of {', '.join(chosen)} is measured here ({there})")
    return kept


def settings(graph: SimulationGraph, island: Island) -> tuple[float, float]:
    """Step [s] and tolerance of the script's own solver; where it has none, a frame and TOLERANCE."""
    solver = cast(Solver, graph.tasks[island.solver].kind)
    if adaptive(solver):
        return graph.settings.clock.speed / graph.settings.clock.fps, setting_of(solver)
    return setting_of(solver), TOLERANCE


def at(solver: Solver, setting: float) -> Solver:
    """The same solver with another step [s] or tolerance."""
    return solver.model_copy(update={"tolerance" if adaptive(solver) else "step": setting})


def setting_of(solver: Solver) -> float:
    """A solver's step [s] or tolerance as requested: its method may use a fraction of the latter."""
    control = solver.stepper().control
    if not control.adaptive:
        return control.first_step
    asked: float = getattr(solver, "tolerance", control.tolerance)
    return asked


def adaptive(solver: Solver) -> bool:
    """Whether a solver's steps follow a tolerance."""
    return solver.stepper().control.adaptive


def prepared(graph: SimulationGraph, island: Island, solver: Solver) -> SimulationGraph:
    """The scene with only one island, by another solver."""
    task = replace(graph.tasks[island.solver], kind=solver)
    return replace(graph, tasks={**graph.tasks, island.solver: task}, islands=(island,))


def run(
    graph: SimulationGraph,
    island: Island,
    solver: Solver,
    longest: float = math.inf,
    seen: list[tuple[float, Floats]] | None = None,
) -> tuple[Instant, IslandRun]:
    """An island's run by a solver, at its end. Raises RunFailure; TooLong after ``longest`` [s] of compiled steps.

    ``seen`` is filled with (time [s], state) at the start and at LOOKS evenly spaced instants or more.
    """
    from sceneql.run.run import Run

    whole = Run(prepared(graph, island, solver))
    march, end = whole.islands[0], graph.settings.clock.end
    moment = None
    even = [end * k / LOOKS for k in range(LOOKS)] if seen is not None else []
    looks = sorted({*even, *(_looks(end) if math.isfinite(longest) else [end])})
    for moment in whole.moments(looks):
        if seen is not None:
            seen.append((moment.time, march.y.copy()))
        if moment.time < end and march.march.statistics.seconds > longest:
            part, span = graph.tasks[island.solver].name, graph.tasks[island.solver].span
            raise TooLong(f"given up after {longest:g} s of run time", part=part, time=moment.time, span=span)
    assert moment is not None
    return moment, march


def _looks(end: float) -> Iterator[float]:
    time = FIRST_LOOK * end
    while time < end:
        yield time
        time *= NEXT_LOOK
    yield end


def measurements(
    graph: SimulationGraph, island: Island, word: str, solver: Solver, reference: Reference
) -> Iterator[Measurement]:
    """Runs of one solver from coarse to fine, until its error reaches the reference's own or runs take long."""
    end = graph.settings.clock.end
    for setting in TOLERANCES if adaptive(solver) else [end / steps for steps in STEPS]:
        found = measure(graph, island, word, at(solver, setting), reference, REPEATS)
        yield found
        if found.error <= reference.uncertainty or found.seconds > ENOUGH_SECONDS:
            return


def measure(
    graph: SimulationGraph, island: Island, word: str, solver: Solver, reference: Reference, repeats: int = 1
) -> Measurement:
    """A measurement of one solver setting: its error, and the least and median time of its runs."""
    title, setting = ", ".join(island.models), setting_of(solver)
    times: list[float] = []
    try:
        while len(times) < repeats and sum(times) < ENOUGH_SECONDS:
            # The first run checks the limit of its time; later runs are timed by their steps alone.
            moment, march = run(graph, island, solver, math.inf if times else LONGEST)
            times.append(march.march.statistics.seconds)
    except RunFailure as failure:
        why = failure.diagnostic.message
        return Measurement(title, word, adaptive(solver), setting, why, math.nan, math.nan, 0, 0)
    if len(times) > 1:
        times = times[1:]
    done = march.march.statistics
    return Measurement(
        title,
        word,
        adaptive(solver),
        setting,
        "ok",
        reference.error(moment, march),
        min(times),
        done.steps,
        done.evaluations,
        reference.worst(moment, march),
        statistics.median(times),
    )


def warm(graph: SimulationGraph, island: Island, solver: Solver) -> float:
    """Compile all that a run needs before it is timed; returns the compilation time [s]."""
    from sceneql.compiled.kernels import compiled

    before = compiled.seconds
    with suppress(RunFailure):  # a failed run has compiled its code, too
        coarse = TOLERANCES[0] if adaptive(solver) else graph.settings.clock.end / STEPS[0]
        run(graph, island, at(solver, coarse), LONGEST)
    return compiled.seconds - before
