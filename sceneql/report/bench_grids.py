"""The part of `bench` on fields on grids: error against cell size, and the linear solvers of their systems."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, cast

from sceneql.files import whole
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Model, Solver
from sceneql.report.bench_methods import TOLERANCE, MethodRun, method_runs
from sceneql.report.bench_methods import told as method_lines
from sceneql.report.bench_schemes import SchemeRun, scheme_runs, told
from sceneql.report.grid_ends import ends_on_grids
from sceneql.report.grid_runs import GridRun, LinearRun, linear_runs, on_grids
from sceneql.report.page import Table, beside
from sceneql.report.plots_grids import error_against_cell, methods_against_time, residuals, schemes_against_time


@dataclass(frozen=True, slots=True)
class GridSection:
    """The results of `bench` for fields on grids."""

    lines: Sequence[str]
    plots: Sequence[tuple[str, Path]]
    tables: Sequence[Table]
    files: Sequence[Path]
    data: dict[str, Any]


def is_field(graph: SimulationGraph, island: Island) -> bool:
    """Whether an island is a single model made of fields."""
    kinds = [graph.tasks[name].kind for name in island.models]
    return len(kinds) == 1 and cast(Model, kinds[0]).is_field


def grid_section(graph: SimulationGraph, stem: Path, schemes: Mapping[str, Mapping[str, Solver]]) -> GridSection | None:
    """Measure the fields of a scene and write files beside ``stem``; None where it has none.

    ``schemes``: the applicable solvers of each island, by its title.
    """
    islands = [island for island in graph.islands if is_field(graph, island)]
    if not islands:
        return None
    lines: list[str] = []
    runs: list[GridRun] = []
    by_schemes: list[SchemeRun] = []
    linear: list[LinearRun] = []
    orders: dict[str, float | None] = {}
    by_methods: list[MethodRun] = []
    of_methods: list[str] = []
    for island in islands:
        title = ", ".join(island.models)
        compared = method_runs(graph, island)
        by_methods += compared
        if compared:
            how = f"by tr_bdf2 at tolerance {TOLERANCE:g}"
            method = f"{title} by methods, {how}, beside the finest {compared[-1].method}:"
            of_methods += [method, *method_lines(compared)]
        if cast(Model, graph.tasks[island.models[0]].kind).field_count() == 0:
            continue  # on elements
        ends, how = ends_on_grids(graph, island)
        found, orders[title] = on_grids(title, ends)
        runs += found
        order = orders[title]
        seen = "no order seen" if order is None else f"observed order {order:.2f} in the cell"
        lines.append(f"{title} on grids, {how} in time: {seen}")
        lines += [
            f"    cell {one.cell:<14.4g} m error {one.error:8.2e}  {one.seconds * 1e3:9.3f} ms  {one.cells:8d} cells"
            for one in found
        ]
        own = list(scheme_runs(graph, island, schemes.get(title, {}), ends))
        by_schemes += own
        if own:
            lines.append(f"{title} by schemes, grids and steps: {len(own)} runs, errors of space and time together")
            lines += told(own)
        mine = list(linear_runs(graph, island))
        linear += mine
        if mine:
            lines.append(f"{title}, one step of {mine[0].step:.3g} s of implicit_euler by linear solver:")
        for one in mine:
            last = f"residual {one.residuals[-1]:.1e} of the first" if one.residuals else "solved at once"
            lines.append(f"    {one.linear:<20} {one.iterations:6d} iterations  {one.seconds * 1e3:9.3f} ms  {last}")
    lines += of_methods
    return _written(graph.name, stem, lines, runs, orders, by_schemes, linear, by_methods)


def _written(
    name: str,
    stem: Path,
    lines: Sequence[str],
    runs: Sequence[GridRun],
    orders: Mapping[str, float | None],
    by_schemes: Sequence[SchemeRun],
    linear: Sequence[LinearRun],
    by_methods: Sequence[MethodRun],
) -> GridSection:
    """Write the files of the section; returns the section."""
    parts: list[tuple[str, str, type, Sequence[Any]]] = [
        ("grids", "Grids", GridRun, runs),
        ("schemes", "Schemes, grids and steps", SchemeRun, by_schemes),
        ("linear", "Linear solvers", LinearRun, linear),
        ("methods", "Finite volumes and finite elements", MethodRun, by_methods),
    ]
    tables, files, plots = [], [], []
    for key, caption, kind, rows in parts:
        path = beside(stem, f"{key}.csv")
        _write_csv(path, kind, rows)
        files.append(path)
        tables.append(_table(caption, kind, rows))
    if by_schemes:
        plots.append(("Error of space and time against run time", beside(stem, "schemes.svg")))
        schemes_against_time(plots[-1][1], name, by_schemes)
    if runs:
        plots.append(("Error of space against cell", beside(stem, "grids.svg")))
        error_against_cell(plots[-1][1], name, runs, orders)
    if any(run.residuals for run in linear):
        plots.append(("Residuals of linear solvers", beside(stem, "linear.svg")))
        residuals(plots[-1][1], name, linear)
    if by_methods:
        plots.append(("Error of space against run time, by methods", beside(stem, "methods.svg")))
        methods_against_time(plots[-1][1], name, by_methods)
    data = {key: [asdict(row) for row in rows] for key, _, _, rows in parts}
    return GridSection(lines, plots, tables, files, data)


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
