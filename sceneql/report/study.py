"""`study`: the runs of a study, their errors, costs and outcomes."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

from sceneql.compiler.studies import Tried, instead, tried
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import SimulationGraph
from sceneql.kinds import Value
from sceneql.language.patch import Patch
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.expect import moments_of, sample
from sceneql.report.work_precision import FIRST_LOOK, NEXT_LOOK, TooLong
from sceneql.run.series import Series, measure

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.run.instant import Instant
    from sceneql.run.run import Run

REPEATS = 3
ENOUGH_SECONDS = 0.5
"""Time of all repeats of a run [s] after which there is no further one."""
LONGEST = 20.0
"""Time of compiled steps [s] after which a reference is given up."""

Load = Callable[[Sequence[Patch]], SimulationGraph]
"""Function that loads the unpruned scene with more patches."""
Outcome = Literal["stable", "inaccurate", "failed", "skipped"]


@dataclass(frozen=True, slots=True)
class Trial:
    """One run of a study."""

    values: tuple[Tried, ...]
    """One value of each path, in order."""
    outcome: Outcome
    why: str
    """Reason of a failed or skipped run."""
    error: float
    """Relative error; NaN where there is none."""
    seconds: float
    """Least run time of the compiled steps over all repeats [s], without compilation."""
    steps: int
    evaluations: int
    measured: dict[str, float]
    """The other measurements of the study, in SI."""
    median: float = math.nan
    """Median run time of the repeats [s]."""


def trials(load: Load, name: str, progress: Callable[[int, int], None] = lambda done, total: None) -> Iterator[Trial]:
    """Run every combination of a study's values. Raises ScriptError for an invalid value."""
    study = load(()).settings.studies[name]
    rows = [tried(path, node) for path, node in study.sweep.items()]
    replaced = {path for path, _, _ in instead(study)}
    truths: dict[tuple[str, ...], tuple[Any, str]] = {}
    for done, values in enumerate(product(*rows)):
        progress(done, math.prod(map(len, rows)))
        own = [value for value in values if value.patch[0] not in replaced]
        key = tuple(value.label for value in own)
        if study.reference is not None and key not in truths:
            truths[key] = _reference(load, name, [*(value.patch for value in own), *instead(study)])
        yield _trial(load([value.patch for value in values]), name, values, truths.get(key, (None, "")))


def _reference(load: Load, name: str, patches: Sequence[Patch]) -> tuple[Any, str]:
    """The reference value of a study (None: there is none), and the reason why there is none."""
    graph = load(patches)
    study = graph.settings.studies[name]
    try:
        times, series, _, _ = _run(graph, [study.of], LONGEST)
    except (RunFailure, LimitRefused, ScriptError, ValueError, TypeError) as failure:
        return None, f"its reference fails: {_told(failure)}"
    return measure(study.of.expr, series, times), ""


def _trial(graph: SimulationGraph, name: str, values: tuple[Tried, ...], truth: tuple[Any, str]) -> Trial:
    import numpy as np

    study = graph.settings.studies[name]
    wanted = [study.of, *study.measure.values(), *([] if study.exact is None else [study.exact])]
    seconds: list[float] = []
    try:
        while len(seconds) < REPEATS and sum(seconds) < ENOUGH_SECONDS:
            times, series, run, taken = _run(graph, wanted, study.longest)
            seconds.append(taken)
    except TooLong as failure:
        return Trial(values, "skipped", failure.message, math.nan, math.nan, 0, 0, {})
    except RunFailure as failure:
        return Trial(values, "failed", _told(failure), math.nan, math.nan, 0, 0, {})
    except (ScriptError, LimitRefused, ValueError, TypeError) as refused:
        return Trial(values, "skipped", _told(refused), math.nan, math.nan, 0, 0, {})
    right, why = truth if study.exact is None else (measure(study.exact.expr, series, times), "")
    error = math.nan if right is None else _relative(measure(study.of.expr, series, times), right)
    outcome: Outcome = "skipped" if right is None else "stable" if error <= study.accuracy else "inaccurate"
    done = [island.march.statistics for island in run.islands]
    more = {each: float(np.max(measure(value.expr, series, times))) for each, value in study.measure.items()}
    return Trial(
        values,
        outcome,
        why,
        error,
        min(seconds[1:] or seconds),
        sum(one.steps for one in done),
        sum(one.evaluations for one in done),
        more,
        statistics.median(seconds[1:] or seconds),
    )


def _run(graph: SimulationGraph, values: Sequence[Value], longest: float) -> tuple[list[float], Series, Run, float]:
    """Times, samples of values at these, the run, and its run time [s]. Raises TooLong beyond ``longest`` [s]."""
    from sceneql.run.run import Run

    times, run = moments_of(graph, values), Run(graph)

    def spent() -> float:
        return sum(island.march.statistics.seconds for island in run.islands)

    def moments() -> Iterator[Instant]:
        look = FIRST_LOOK * times[-1]
        for time in times:
            while look < time:
                run.at(look)
                look *= NEXT_LOOK
                if spent() > longest:
                    part = ", ".join(name for island in run.islands for name in island.island.models)
                    raise TooLong(f"given up after {longest:g} s of run time", part=part, time=look, span=None)
            yield run.at(time)

    series = sample(moments(), times, values)
    return times, series, run, spent()


def _relative(found: Floats, right: Floats) -> float:
    """Largest difference, relative to the largest true number; inf where a number is not finite."""
    import numpy as np

    error = float(np.max(np.abs(np.asarray(found) - right))) / (float(np.max(np.abs(right))) or 1.0)
    return error if math.isfinite(error) else math.inf


def _told(failure: Exception) -> str:
    if isinstance(failure, RunFailure | LimitRefused):
        return failure.diagnostic.message
    return failure.diagnostics[0].message if isinstance(failure, ScriptError) else str(failure)
