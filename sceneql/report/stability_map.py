"""The outcome of an island under each solver while a value of the script, or the step, is swept over decades."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Solver
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.reference import reference
from sceneql.report.stability_sweep import Sweep, around
from sceneql.report.work_precision import Reference, TooLong, adaptive, at, prepared, run, setting_of, solvers

if TYPE_CHECKING:
    from sceneql.frame import Floats

TOLERANCES = ((1e-10, 1e-9), (1e-7, 1e-6))
"""Tolerances of the references, tight enough to see inaccurate runs."""
RAN_AWAY = 10.0
"""Relative error at the end above which a run counts as failed, even where all its numbers are finite."""
METHODS = ("radau", "dopri5")
"""Methods of the references: a sweep over stiffness needs one for stiff systems."""
LONGEST = 5.0
"""Time of compiled steps [s] after which a run is given up."""
MOST_CALLS = 10_000
"""Largest number of evaluations of a rate by a reference method that is not our own."""
SLOWEST = 1e-3
"""Middle of the steps tried, relative to the run's end, where no rate depends on the state."""

Load = Callable[[Sequence[str]], SimulationGraph]
"""Function that loads the scene with more patches."""


@dataclass(frozen=True, slots=True)
class Cell:
    """One run of an island by one solver at one value."""

    island: str
    solver: str
    value: float
    adaptive: bool
    setting: float
    """Step [s], or relative tolerance."""
    outcome: Literal["stable", "inaccurate", "failed", "skipped"]
    why: str
    """Reason of a failed or skipped run; the worst quantity of an inaccurate one."""
    error: float
    """Relative error at the end; NaN where there is none."""
    bound: float
    """Largest stable step [s] by the spectrum at the start; inf: any; NaN: not computed (many states)."""
    seconds: float
    """Run time of the compiled steps."""
    steps: int

    @property
    def beyond(self) -> bool:
        """Whether the step exceeds the bound known before the run."""
        return not self.adaptive and self.setting > self.bound


def default_sweep(graph: SimulationGraph) -> Sweep:
    """Steps around that of the fastest mode of all islands at their starts."""
    from sceneql.march.modes import modes_of
    from sceneql.run.run import Run

    found = [modes_of(island.march) for island in Run(graph).islands]
    fastest = max((modes.fastest for modes in found if modes is not None), default=0.0)
    end = graph.settings.clock.end
    return around(2.0 / fastest if fastest > 0 else SLOWEST * end, end)


def cells(
    load: Load,
    sweep: Sweep,
    catalogue: Catalogue,
    largest_error: float,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Iterator[Cell]:
    """Runs by every applicable solver at every value, on every island. Raises ScriptError for an invalid value."""
    truths: dict[tuple[str, ...], Reference] = {}
    for done, value in enumerate(sweep.values):
        progress(done, len(sweep.values))
        graph = load(sweep.sets(value))
        for island in graph.islands:
            if not sweep.own or island.models not in truths:
                truths[island.models] = _reference(graph, island, catalogue)
            for word, solver in solvers(graph, island, catalogue).items():
                if sweep.own and adaptive(solver) != (sweep.path == "tolerance"):
                    continue
                own = at(solver, value) if sweep.own else solver
                yield _cell(graph, island, word, own, value, truths[island.models], largest_error)


def _reference(graph: SimulationGraph, island: Island, catalogue: Catalogue) -> Reference:
    try:
        return reference(graph, island, catalogue, TOLERANCES, LONGEST, MOST_CALLS, METHODS)
    except (RunFailure, LimitRefused) as failure:
        return Reference(lambda moment, march: math.nan, f"nothing: {failure.diagnostic.message}", math.inf)


def _cell(
    graph: SimulationGraph,
    island: Island,
    word: str,
    solver: Solver,
    value: float,
    truth: Reference,
    largest_error: float,
) -> Cell:
    outcome: Literal["stable", "inaccurate", "failed", "skipped"] = "skipped"
    why, error, seconds, steps = "", math.nan, 0.0, 0
    try:
        looks: list[tuple[float, Floats]] = []
        moment, march = run(graph, island, solver, LONGEST, looks)
        error, done = truth.error(moment, march), march.march.statistics
        seconds, steps = done.seconds, done.steps
        if math.isnan(error):
            why = f"it ran, but is compared with {truth.because}"
        elif error > RAN_AWAY:
            outcome, why = "failed", f"it ran away: its end is off by {error:.2g} times the range of what is right"
        else:
            why = truth.damped(march, looks)
            outcome = "inaccurate" if why or error > largest_error else "stable"
            why = why or (f"most in {truth.worst(moment, march)}" if outcome == "inaccurate" else "")
    except TooLong as long:
        why = long.message
    except RunFailure as failure:
        outcome, why = "failed", failure.diagnostic.message
    except (ValueError, TypeError, LimitRefused, ScriptError) as refused:
        why = f"{word} does not apply: {refused}"
    bound = _bound(graph, island, solver)
    title = ", ".join(island.models)
    return Cell(title, word, value, adaptive(solver), setting_of(solver), outcome, why, error, bound, seconds, steps)


def _bound(graph: SimulationGraph, island: Island, solver: Solver) -> float:
    from sceneql.march.modes import DENSE
    from sceneql.march.stability import stability
    from sceneql.run.run import Run

    if adaptive(solver):
        return math.inf
    try:
        chosen = Run(prepared(graph, island, solver)).islands[0]
    except (LimitRefused, ScriptError):  # told where it is run
        return math.nan
    return math.nan if len(chosen.march.system.y) > DENSE else stability(chosen.march, chosen.methods.bounding).step
