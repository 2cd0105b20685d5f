"""The part of `bench` on fields on grids: their error against the cells, and how their linear systems are solved."""

from __future__ import annotations

import csv
import io
import math
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields, replace
from itertools import pairwise, product
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast, get_args

from sceneql.failure import LimitRefused, RunFailure
from sceneql.files import whole
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Model, Solver
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.page import Table, beside
from sceneql.report.work_precision import ENOUGH_SECONDS, LONGEST, run, settings

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.simulation.grids.medium import FieldLayout, Medium
    from sceneql.simulation.run import IslandRun

MOST_CELLS = 100_000
"""Of the finest grid, or the script's own where that has more."""
GRIDS = 6
FINER = 2
"""Halvings of the script's cell at most."""
FEWEST = 200
"""Cells that a grid has for a coarser one to be tried."""
REPEATS = 3
TOLERANCE = 1e-6
"""In time, where no exact solution is known."""


@dataclass(frozen=True, slots=True)
class GridRun:
    """A field on one grid at the end of the run."""

    island: str
    cell: float
    """Side of a cell [m]."""
    cells: int
    error: float
    """Root mean square, in parts of the largest value: by how far it is from the next finer grid, and the order."""
    seconds: float
    """Run time of the compiled steps, or of the exact solution."""


@dataclass(frozen=True, slots=True)
class LinearRun:
    """One step of implicit_euler by a linear solver."""

    island: str
    linear: str
    step: float
    """[s]"""
    iterations: int
    seconds: float
    residuals: tuple[float, ...]
    """After each look at it, in parts of the first; empty where it is solved at once."""


@dataclass(frozen=True, slots=True, eq=False)
class _End:
    """A field at the end on one grid."""

    cell: float
    seconds: float
    layout: FieldLayout
    inside: Any
    """(cells,) bool."""
    values: Floats

    @property
    def cells(self) -> int:
        """Those of the domain."""
        return int(self.inside.sum())


@dataclass(frozen=True, slots=True)
class GridSection:
    """What `bench` says of fields on grids."""

    lines: Sequence[str]
    tables: Sequence[Table]
    files: Sequence[Path]
    data: dict[str, Any]


def is_field(graph: SimulationGraph, island: Island) -> bool:
    """Whether an island is one model of fields and nothing else."""
    kinds = [graph.tasks[name].kind for name in island.models]
    return len(kinds) == 1 and cast(Model, kinds[0]).is_field


def grid_section(graph: SimulationGraph, stem: Path) -> GridSection | None:
    """Measure the fields of a scene, beside ``stem``; None where it has none."""
    islands = [island for island in graph.islands if is_field(graph, island)]
    if not islands:
        return None
    lines: list[str] = []
    runs: list[GridRun] = []
    linear: list[LinearRun] = []
    for island in islands:
        found, order, how = on_grids(graph, island)
        runs += found
        told = "no order seen" if order is None else f"observed order {order:.2f} in the cell"
        lines.append(f"{island.models[0]} on grids, {how} in time: {told}")
        lines += [
            f"    cell {one.cell:<14.4g} m error {one.error:8.2e}  {one.seconds * 1e3:9.3f} ms  {one.cells:8d} cells"
            for one in found
        ]
        mine = list(linear_runs(graph, island))
        linear += mine
        if mine:
            lines.append(f"{island.models[0]}, one step of {mine[0].step:.3g} s of implicit_euler by linear solver:")
        for one in mine:
            last = f"residual {one.residuals[-1]:.1e} of the first" if one.residuals else "solved at once"
            lines.append(f"    {one.linear:<20} {one.iterations:6d} iterations  {one.seconds * 1e3:9.3f} ms  {last}")
    files = [beside(stem, "grids.csv"), beside(stem, "linear.csv")]
    for path, kind, rows in ((files[0], GridRun, runs), (files[1], LinearRun, linear)):
        _write_csv(path, kind, rows)
    tables = [_table("Grids", GridRun, runs), _table("Linear solvers", LinearRun, linear)]
    return GridSection(
        lines, tables, files, {"grids": [asdict(r) for r in runs], "linear": [asdict(r) for r in linear]}
    )


def on_grids(graph: SimulationGraph, island: Island) -> tuple[list[GridRun], float | None, str]:
    """Runs on grids from coarse to fine, the observed order in the cell, and how time was solved."""
    solver, how = _in_time(graph, island)
    kind = cast("Medium", graph.tasks[island.models[0]].kind)
    ends = [_end(graph, island, solver, kind.cell)]
    shape = ends[0].layout.shape
    finer = math.floor(math.log2(max(1.0, MOST_CELLS / math.prod(shape))) / (3 if shape[2] > 1 else 2))
    try:
        for number in range(1, min(FINER, finer) + 1):
            if ends[0].seconds > ENOUGH_SECONDS:
                break
            ends.insert(0, _end(graph, island, solver, kind.cell * 0.5**number))
        while len(ends) < GRIDS and ends[-1].cells >= FEWEST:
            ends.append(_end(graph, island, solver, 2.0 * ends[-1].cell))
    except (ScriptError, LimitRefused, RunFailure):
        pass  # no grid as fine or as coarse as that
    title, rows = ", ".join(island.models), []
    pairs = list(pairwise(ends))
    differences = [_difference(coarse, fine) for fine, coarse in pairs]
    order = None
    if len(differences) > 1 and min(differences) > 0.0:
        order = math.log2(differences[-1] / differences[0]) / (len(differences) - 1)
    share = 1.0 - 2.0 ** -min(4.0, max(0.5, order or 2.0))
    for (_, coarse), difference in zip(pairs, differences, strict=True):
        rows.append(GridRun(title, coarse.cell, coarse.cells, difference / share, coarse.seconds))
    return rows[::-1], order, how


def linear_runs(graph: SimulationGraph, island: Island) -> Iterator[LinearRun]:
    """One step of the script's length by every linear solver that applies; what does not converge is left out."""
    from sceneql.simulation.grids.implicit import report
    from sceneql.simulation.grids.names import Linear
    from sceneql.simulation.solvers.implicit_euler import ImplicitEuler

    step = min(settings(graph, island)[0], graph.settings.clock.end)
    for name in get_args(Linear):
        if name == "auto":
            continue
        times: list[float] = []
        try:
            while len(times) < REPEATS:
                march = _island(graph, island, ImplicitEuler(step=step, linear=name)).march
                if march.system.grid is None:
                    return  # several fields
                march.advance(step)
                times.append(march.statistics.seconds)
        except (LimitRefused, RunFailure):
            continue
        done = report(march)
        first = done.residuals[0] if done.residuals and done.residuals[0] > 0.0 else 1.0
        shares = tuple(size / first for size in done.residuals)
        yield LinearRun(", ".join(island.models), name, step, done.iterations, statistics.median(times), shares)


def _in_time(graph: SimulationGraph, island: Island) -> tuple[Solver, str]:
    """What solves an island in time without an error to speak of."""
    from sceneql.simulation.solvers.exact import Exact
    from sceneql.simulation.solvers.tr_bdf2 import TrBdf2

    try:
        _island(graph, island, Exact())
    except (LimitRefused, ScriptError):
        return TrBdf2(tolerance=TOLERANCE), f"by tr_bdf2 at tolerance {TOLERANCE:g}"
    return Exact(), "exact"


def _island(graph: SimulationGraph, island: Island, solver: Solver) -> IslandRun:
    from sceneql.simulation.run import IslandRun

    task = replace(graph.tasks[island.solver], kind=solver)
    return IslandRun(replace(graph, tasks={**graph.tasks, island.solver: task}, islands=(island,)), island)


def _end(graph: SimulationGraph, island: Island, solver: Solver, cell: float) -> _End:
    """The model's first field at the end on a grid of that cell. Raises RunFailure, LimitRefused, ScriptError."""
    name = island.models[0]
    kind = cast("Medium", graph.tasks[name].kind).model_copy(update={"cell": cell})
    patched = replace(graph, tasks={**graph.tasks, name: replace(graph.tasks[name], kind=kind)})
    times = []
    for _ in range(REPEATS):
        _, march = run(patched, island, solver, LONGEST)
        times.append(march.march.statistics.seconds)
        if sum(times) > ENOUGH_SECONDS:
            break
    state = march.state(name)
    shown = kind.shows(name)
    assert shown is not None
    layout: FieldLayout = cast("Any", kind).layout(state, shown.links[0].output)
    volumes = state.floats[layout.volumes_at : layout.volumes_at + layout.count]
    values = state.y[layout.at : layout.at + layout.count]
    return _End(cell, statistics.median(times), layout, volumes > 0.0, values.copy())


def _difference(coarse: _End, fine: _End) -> float:
    """Root mean square difference at the coarse cells' centers that the finer grid knows, by the largest value."""
    import numpy as np

    cubic, known = _interpolated(fine, coarse.layout.centers(), 4)
    straight, inside = _interpolated(fine, coarse.layout.centers(), 2)
    wrong = (coarse.values - np.where(known, cubic, straight))[coarse.inside & (known | inside)]
    largest = float(np.abs(fine.values).max()) or 1.0
    return float(np.sqrt(np.mean(wrong**2))) / largest if len(wrong) else 0.0


def _interpolated(end: _End, places: Floats, count: int) -> tuple[Floats, Any]:
    """Lagrange interpolation by ``count`` cells along each axis at places (k, 3): values, if all are inside."""
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


def _table(caption: str, kind: type, runs: Sequence[Any]) -> Table:
    head = [item.name.replace("_", " ") for item in fields(kind)]
    return Table(caption, head, [[(_cell(value), "") for value in asdict(run).values()] for run in runs])


def _cell(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(f"{one:.0e}" for one in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _write_csv(path: Path, kind: type, runs: Sequence[Any]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(item.name for item in fields(kind))
    for row in runs:
        cells = asdict(row).values()
        writer.writerow(" ".join(map(repr, cell)) if isinstance(cell, tuple) else cell for cell in cells)
    with whole(path) as file:
        file.write(text.getvalue().encode())
