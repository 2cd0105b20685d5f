"""The part of `bench` on fields by finite volumes and by finite elements: error in space against run time."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Solver
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.work_precision import run

if TYPE_CHECKING:
    from sceneql.frame import Floats

LEVELS = (4.0, 2.0, 1.0, 0.5, 0.25)
"""Cell sizes of fields relative to the script's own, from coarse to fine."""
ENOUGH_SECONDS = 15.0
"""Run time with set-up [s] after which no finer run is tried."""
LONGEST = 10.0
"""Time of compiled steps [s] after which a run is given up."""
REPEATS = 3
TOLERANCE = 1e-6
"""Relative tolerance of the time integration."""


@dataclass(frozen=True, slots=True)
class MethodRun:
    """A run of a field by one method with one cell size, at the end."""

    island: str
    method: str
    cell: float
    """[m]"""
    unknowns: int
    error: float
    """Root mean square error over the volume, relative to the largest value."""
    seconds: float
    """Median run time of the compiled steps [s]."""
    setup: float
    """Time for making cells or elements and their matrices [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class _End:
    cell: float
    seconds: float
    setup: float
    places: Floats
    values: Floats
    weights: Floats
    unknowns: int
    field: Any
    """Function from places (k, 3) to values (k,)."""


def method_runs(graph: SimulationGraph, island: Island) -> list[MethodRun]:
    """Runs by all methods of a model, compared with the best elements on the finest mesh that they are run on.

    Empty where the model has only one method.
    """
    from sceneql.words.solvers.tr_bdf2 import TrBdf2

    title = ", ".join(island.models)
    kind: Any = graph.tasks[island.models[0]].kind
    if not hasattr(kind, "by_methods"):
        return []
    solver = TrBdf2(tolerance=TOLERANCE)
    methods: Mapping[str, Any] = kind.by_methods()
    if len(methods) < 2:
        return []
    ends = {name: _ends(graph, island, one, solver, LEVELS) for name, one in methods.items()}
    best = list(ends)[-1]
    if not ends[best]:
        return []
    reference = ends[best].pop()
    largest = float(abs(reference.values).max()) or 1.0
    return [
        MethodRun(title, name, end.cell, end.unknowns, _error(end, reference) / largest, end.seconds, end.setup)
        for name, some in ends.items()
        for end in some
    ]


def told(runs: Sequence[MethodRun]) -> list[str]:
    """A line of text for each run, with the observed order between it and the coarser one."""
    lines, before = [], None
    for one in runs:
        order = ""
        if before is not None and before.method == one.method and one.error > 0.0:
            order = f"  order {math.log(before.error / one.error) / math.log(before.cell / one.cell):5.2f}"
        lines.append(
            f"    {one.method:<6} cell {one.cell:<10.4g} m error {one.error:8.2e}  {one.seconds * 1e3:9.3f} ms"
            f"  set-up {one.setup * 1e3:8.1f} ms  {one.unknowns:7d} unknowns{order}"
        )
        before = one
    return lines


def _ends(graph: SimulationGraph, island: Island, kind: Any, solver: Solver, levels: Sequence[float]) -> list[_End]:
    """Results from coarse to fine, of runs that are possible; the finest takes long, or is the last level."""
    found: list[_End] = []
    for part in levels:
        try:
            found.append(_end(graph, island, kind.resized(part), solver))
        except (ScriptError, LimitRefused):
            continue
        except RunFailure:
            break
        if found[-1].seconds + found[-1].setup > ENOUGH_SECONDS:
            break
    return found


def _end(graph: SimulationGraph, island: Island, kind: Any, solver: Solver) -> _End:
    name = island.models[0]
    patched = replace(graph, tasks={**graph.tasks, name: replace(graph.tasks[name], kind=kind)})
    steps, whole = [], []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        _, march = run(patched, island, solver, LONGEST)
        steps.append(march.march.statistics.seconds)
        whole.append(time.perf_counter() - begun - steps[-1])
        if steps[-1] + whole[-1] > 0.5 * ENOUGH_SECONDS:
            break
    state = march.state(name)
    unknowns, along = kind.along(name, state)
    seconds = statistics.median(steps[1:] or steps)
    places, values, weights = kind.samples(state)
    return _End(kind.spaced(), seconds, min(whole), places, values, weights, unknowns, along)


def _error(end: _End, reference: _End) -> float:
    import numpy as np

    return float(np.sqrt(np.average((end.values - reference.field(end.places)) ** 2, weights=end.weights)))
