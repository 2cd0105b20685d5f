"""Runs of the solids of an island by kinds of elements and spacings, within a budget of time."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Expect, Solver, Value
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.expression import Call, Link, walk
from sceneql.report.expect import moments_of, sample
from sceneql.report.grid_ends import island_by
from sceneql.report.work_precision import TooLong, prepared
from sceneql.run.series import measure, plain, wanted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sceneql.frame import Floats
    from sceneql.run.instant import Instant
    from sceneql.run.run import Run

PARTS = tuple(2.0 ** (0.5 * k) for k in (3, 2, 1, 0, -1, -2))
"""Spacings relative to the script's own, from coarse to fine."""
BUDGET = 60.0
"""Time of all runs of an island [s], without compilation; what is expected to go beyond it is not begun."""
GROWTH = 5.0
"""Power of the spacing by which the time of a run is expected to grow: three for elements, two for factors."""
REPEATS, ENOUGH_SECONDS = 3, 0.5
"""Largest number of runs for a time, and the time of all of them [s] after which there is no further one."""
LOOKS = 16
"""Number of instants at which the time of a run is compared with what is left."""


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """The end of a run by one kind of elements at one spacing."""

    element: str
    spacing: float
    """[m]"""
    sides: tuple[float, ...]
    """[m] How large its elements are, along each side of a block, else in the mean."""
    unknowns: int
    seconds: float
    """Median time of the compiled steps [s]."""
    setup: float
    """Least time for meshes, matrices and the first rest [s]."""
    compiling: float
    """Time of compilation [s], which is in neither."""
    samples: tuple[Floats, Floats, Floats]
    """Places of the material (k, 3) [m], displacements there (k, 3) [m], volumes [m^3] that they stand for."""
    along: Sequence[tuple[int, Callable[[Floats], Floats]]]
    """For each solid the number of its samples, and its displacements [m] as a function of such places."""
    watched: Mapping[str, Floats]
    """Values of what the scene expects or records, at the end or over the run."""
    right: Mapping[str, Floats]
    """Exact values that the scene tells."""


@dataclass(frozen=True, slots=True)
class ElementRun:
    """A quantity of a run by one kind of elements at one spacing."""

    island: str
    quantity: str
    """What the scene expects or records, or the displacements over the volume."""
    element: str
    spacing: float
    """[m]"""
    unknowns: int
    value: float
    """Its largest number, in SI."""
    error: float
    """Relative to the largest true number; of displacements the root mean square."""
    order: float
    """Observed in the size of elements, between this run and the last one of coarser elements of about the same shape;
    NaN where there is none."""
    seconds: float
    """Time of the compiled steps [s]."""
    setup: float
    """Time for meshes, matrices and the first rest [s]."""
    compiling: float
    """Time of compilation [s], which is in neither."""


def solids(graph: SimulationGraph, island: Island) -> list[str]:
    """The models of an island whose elements and spacing may be chosen."""
    kinds: dict[str, Any] = {name: graph.tasks[name].kind for name in island.models}
    return [name for name, kind in kinds.items() if not kind.is_field and hasattr(kind, "by_methods")]


def best_of(graph: SimulationGraph, name: str) -> str:
    """The element whose finest run all others are compared with."""
    kind: Any = graph.tasks[name].kind
    return str(list(kind.by_methods())[-1])


def element_runs(graph: SimulationGraph, island: Island, say: Callable[[str], None]) -> Iterator[Solved]:
    """Runs from coarse to fine, all elements at each spacing; ``say`` gets a line for each that is not possible."""
    names, solver = solids(graph, island), cast(Solver, graph.tasks[island.solver].kind)
    island_by(graph, island, solver)  # the spacing of those whose script leaves that to them
    methods: dict[str, Mapping[str, Any]] = {name: cast("Any", graph.tasks[name].kind).by_methods() for name in names}
    families = [one for one in methods[names[0]] if all(one in some for some in methods.values())]
    left, last = BUDGET, dict[str, Solved]()
    for part in PARTS:
        for one in list(families):
            before = last.get(one)
            kinds = {name: methods[name][one].resized(part) for name in names}
            if before is not None:
                ahead = (before.spacing / (kinds[names[0]].spaced() or before.spacing)) ** GROWTH
                if (ahead := ahead * (before.seconds + before.setup)) > left:
                    say(f"{one} at {kinds[names[0]].spaced():.4g} m is not tried: it would take about {ahead:.0f} s")
                    families.remove(one)
                    continue
            begun, compiling = time.perf_counter(), 0.0
            try:
                found = _solved(graph, island, kinds, one, solver, left)
                compiling = found.compiling
            except (ScriptError, LimitRefused) as refused:
                say(f"{one} at {part:.3g} of the spacing is refused: {_told(refused)}")
                continue
            except RunFailure as failure:
                say(f"{one} at {part:.3g} of the spacing: {_told(failure)}")
                if isinstance(failure, TooLong):
                    families.remove(one)
                continue
            finally:
                left -= time.perf_counter() - begun - compiling
            if before is None or found.unknowns != before.unknowns:
                last[one] = found
                yield found


def _solved(
    graph: SimulationGraph, island: Island, kinds: Mapping[str, Any], element: str, solver: Solver, left: float
) -> Solved:
    from sceneql.compiled.kernels import compiled

    parts = {name: replace(graph.tasks[name], kind=kind) for name, kind in kinds.items()}
    patched = prepared(replace(graph, tasks={**graph.tasks, **parts}), island, solver)
    steps: list[float] = []
    whole: list[float] = []
    compiling, total = 0.0, 0.0
    while not steps or (len(steps) < REPEATS and total < min(ENOUGH_SECONDS, 0.2 * left)):
        begun, before = time.perf_counter(), compiled.seconds
        run, watched, right = _run(patched, island, left, solver.static)
        spent, took = time.perf_counter() - begun, compiled.seconds - before
        done = run.islands[0].march.statistics.seconds
        if took > 0.0 and compiling == 0.0 and done < ENOUGH_SECONDS:
            compiling = took
            continue  # code that was compiled just now is timed by the next run
        compiling += took
        steps.append(done)
        whole.append(max(0.0, spent - done - took))
        total += spent
    states = {name: run.state(name) for name in kinds}
    own = [(kind.samples(states[name]), kind.along(name, states[name])) for name, kind in kinds.items()]
    import numpy as np

    samples = tuple(np.concatenate(some) for some in zip(*(one for one, _ in own), strict=True))
    along = [(len(one[0]), field) for one, (_, field) in own]
    first = next(iter(kinds))
    spacing, sides = kinds[first].spaced(), kinds[first].sides(states[first])
    unknowns = sum(count for _, (count, _) in own)
    return Solved(
        element, spacing, sides, unknowns, statistics.median(steps), min(whole), compiling,
        cast("tuple[Floats, Floats, Floats]", samples), along, watched, right,
    )  # fmt: skip


def _run(
    graph: SimulationGraph, island: Island, left: float, static: bool
) -> tuple[Run, dict[str, Floats], dict[str, Floats]]:
    """A run, the watched values and the exact ones. Raises TooLong after ``left`` [s] of steps."""
    from sceneql.run.run import Run

    values, exact = watched_of(graph, island)
    every, end = moments_of(graph, [*values.values(), *exact.values()]), graph.settings.clock.end
    needed = {end}
    for value in (*values.values(), *exact.values()):
        for _, when in wanted(value.expr, every[-1:] if plain(value.expr) else every, every):
            needed |= set(when)
    times, run = sorted(needed), Run(graph)

    def moments() -> Iterator[Instant]:
        looks = [] if static else [end * k / LOOKS for k in range(1, LOOKS)]
        for instant in times:
            while looks and looks[0] < instant:
                run.at(looks.pop(0))
                if run.islands[0].march.statistics.seconds > left:
                    raise TooLong(f"given up after {left:.0f} s", part=island.models[0], time=instant, span=None)
            yield run.at(instant)

    import numpy as np

    series = sample(moments(), times, [*values.values(), *exact.values()])
    found = {name: np.asarray(measure(value.expr, series, times), dtype=float) for name, value in values.items()}
    right = {name: np.asarray(measure(value.expr, series, times), dtype=float) for name, value in exact.items()}
    return run, found, right


def watched_of(graph: SimulationGraph, island: Island) -> tuple[dict[str, Value], dict[str, Value]]:
    """What a scene expects of an island, else what it records of it; and the exact values that it tells, by name.

    Values with an entry a node cannot be compared between meshes and are left out, except for their extremes.
    """
    own = {*island.models, *(name for name, _, _ in island.contacts)}
    expected: dict[str, Expect] = {
        name: one for name, one in graph.settings.expect.items() if one.variant is None and _of(one.of, own)
    }
    if expected:
        told = {name: one.value for name, one in expected.items() if "exact" in one.because}
        exact = {name: value for name, value in told.items() if value is not None}
        return {name: one.of for name, one in expected.items()}, exact
    outputs: list[Any] = [task.kind for task in graph.tasks.values() if task.family == "outputs"]
    recorded = [value for one in outputs if isinstance(of := getattr(one, "of", None), tuple) for value in of]
    found = {}
    for value in recorded:
        if isinstance(value, Value) and value.span is not None and _of(value, own):
            found[" ".join(value.span.text.split())] = value
    return found, {}


def _of(value: Value, own: set[str]) -> bool:
    """Whether a value is of these parts alone, and does not count on the nodes of a mesh."""
    nodes = list(walk(value.expr))
    links = {node.task for node in nodes if isinstance(node, Link)}
    picked = [node.args[0] for node in nodes if isinstance(node, Call) and node.op == "item"]
    listed = any(None in (one.type.shape or ()) for one in (value.expr, *picked))
    return bool(links) and links <= own and not listed


def relative(found: Any, right: Any) -> float:
    """Largest difference relative to the largest true number; NaN where shapes differ or a number is not finite."""
    import numpy as np

    if np.shape(found) != np.shape(right):
        return math.nan
    error = float(np.max(np.abs(found - right), initial=0.0)) / (float(np.max(np.abs(right), initial=0.0)) or 1.0)
    return error if math.isfinite(error) else math.nan


def between(one: Solved, other: Solved) -> float:
    """Root mean square difference of displacements over the volume, relative to the other's largest."""
    import numpy as np

    places, moved, weights = one.samples
    ends = np.cumsum([count for count, _ in one.along])[:-1]
    parts = zip(np.split(places, ends), other.along, strict=True)
    there = np.concatenate([field(some) for some, (_, field) in parts])
    largest = float((other.samples[1] ** 2).sum(axis=1).max(initial=0.0)) ** 0.5 or 1.0
    return float(np.sqrt(np.average(((moved - there) ** 2).sum(axis=1), weights=weights))) / largest


def _told(failure: Exception) -> str:
    if isinstance(failure, RunFailure | LimitRefused):
        return failure.diagnostic.message
    return failure.diagnostics[0].message if isinstance(failure, ScriptError) else str(failure)
