"""A field at the end of a run on successive grids, and the difference between two of them."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, cast

from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Solver
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.work_precision import ENOUGH_SECONDS, LONGEST, run

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import FieldLayout, Medium
    from sceneql.run.run import IslandRun

MOST_CELLS = 100_000
"""Largest number of cells of the finest grid, unless the script's own has more."""
GRIDS = 6
FINER = 2
"""Largest number of halvings of the script's cell."""
FEWEST = 200
"""Smallest number of cells of a grid for which a coarser one is tried."""
REPEATS = 3
TOLERANCE = 1e-6
"""Tolerance in time, where no exact solution is known."""


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """A field at the end of a run on one grid."""

    cell: float
    seconds: float
    steps: int
    layout: FieldLayout
    inside: Any
    """(cells,) bool."""
    values: Floats

    @property
    def cells(self) -> int:
        """Number of cells inside the domain."""
        return int(self.inside.sum())


def ends_on_grids(graph: SimulationGraph, island: Island) -> tuple[list[End], str]:
    """The field at the end on grids from fine to coarse, with negligible time error, and the method in time.

    Each grid has cells of twice the size of the one before. Raises RunFailure, LimitRefused or ScriptError where the
    script's own grid fails.
    """
    solver, how = _in_time(graph, island)
    kind = cast("Medium", graph.tasks[island.models[0]].kind)
    ends = [end_on(graph, island, solver, kind.cell)]
    shape = ends[0].layout.shape
    finer = math.floor(math.log2(max(1.0, MOST_CELLS / math.prod(shape))) / (3 if shape[2] > 1 else 2))
    try:
        for number in range(1, min(FINER, finer) + 1):
            if ends[0].seconds > ENOUGH_SECONDS:
                break
            ends.insert(0, end_on(graph, island, solver, kind.cell * 0.5**number))
        while len(ends) < GRIDS and ends[-1].cells >= FEWEST:
            ends.append(end_on(graph, island, solver, 2.0 * ends[-1].cell))
    except (ScriptError, LimitRefused, RunFailure):
        pass  # that grid is too fine or too coarse
    return ends, how


def _in_time(graph: SimulationGraph, island: Island) -> tuple[Solver, str]:
    """A solver of the island with negligible time error, and its description."""
    from sceneql.words.solvers.exact import Exact
    from sceneql.words.solvers.tr_bdf2 import TrBdf2

    try:
        island_by(graph, island, Exact())
    except (LimitRefused, ScriptError):
        return TrBdf2(tolerance=TOLERANCE), f"by tr_bdf2 at tolerance {TOLERANCE:g}"
    return Exact(), "exact"


def island_by(graph: SimulationGraph, island: Island, solver: Solver) -> IslandRun:
    """An island of a scene at its start, by another solver."""
    from sceneql.run.run import IslandRun

    task = replace(graph.tasks[island.solver], kind=solver)
    return IslandRun(replace(graph, tasks={**graph.tasks, island.solver: task}, islands=(island,)), island)


def end_on(
    graph: SimulationGraph, island: Island, solver: Solver, cell: float, longest: float = LONGEST,
    enough: float = ENOUGH_SECONDS,
) -> End:  # fmt: skip
    """The model's first field at the end, on a grid of given cell size.

    Its run time is the median of repeats, until ``enough`` [s] in total; a run is given up after ``longest`` [s].
    Raises RunFailure, LimitRefused, ScriptError.
    """
    name = island.models[0]
    kind = cast("Medium", graph.tasks[name].kind).model_copy(update={"cell": cell})
    patched = replace(graph, tasks={**graph.tasks, name: replace(graph.tasks[name], kind=kind)})
    times: list[float] = []
    for _ in range(REPEATS):
        # The first run checks the limit of its time; later runs are timed by their steps alone.
        _, march = run(patched, island, solver, math.inf if times else longest)
        times.append(march.march.statistics.seconds)
        if sum(times) > enough:
            break
    state = march.state(name)
    shown = kind.shows(name)
    assert shown is not None
    layout: FieldLayout = cast("Any", kind).layout(state, shown.links[0].output)
    volumes = state.floats[layout.volumes_at : layout.volumes_at + layout.count]
    values = state.y[layout.at : layout.at + layout.count]
    done = march.march.statistics
    return End(cell, statistics.median(times[1:] or times), done.steps, layout, volumes > 0.0, values.copy())


def difference(coarse: End, fine: End) -> float:
    """Root mean square difference at the coarse cells' centers inside the finer grid, relative to the largest value."""
    import numpy as np

    cubic, known = _interpolated(fine, coarse.layout.centers(), 4)
    straight, inside = _interpolated(fine, coarse.layout.centers(), 2)
    wrong = (coarse.values - np.where(known, cubic, straight))[coarse.inside & (known | inside)]
    largest = float(np.abs(fine.values).max()) or 1.0
    return float(np.sqrt(np.mean(wrong**2))) / largest if len(wrong) else 0.0


def _interpolated(end: End, places: Floats, count: int) -> tuple[Floats, Any]:
    """Lagrange interpolation by ``count`` cells along each axis at places (k, 3): values; whether all are inside."""
    import numpy as np

    shape, values, inside = end.layout.shape, np.zeros(len(places)), np.ones(len(places), dtype=bool)
    axes = [k for k in range(3) if shape[k] > 1]
    firsts, weights = [], []
    for k in axes:
        at = (places[:, k] - end.layout.low[k]) / end.layout.spacing[k] - 0.5
        first = np.clip(np.floor(at + 1e-9).astype(int) - (count // 2 - 1), 0, max(0, shape[k] - count))
        part = at - first
        nodes = range(count)
        firsts.append(first)
        weights.append([math.prod((part - m) / (n - m) for m in nodes if m != n) for n in nodes])
    if any(shape[k] < count for k in axes):
        return values, ~inside
    strides = (1, shape[0], shape[0] * shape[1])
    for corner in product(range(count), repeat=len(axes)):
        index = sum((first + n) * strides[k] for first, n, k in zip(firsts, corner, axes, strict=True))
        values += math.prod(weight[n] for weight, n in zip(weights, corner, strict=True)) * end.values[index]
        inside &= end.inside[index]
    return values, inside
