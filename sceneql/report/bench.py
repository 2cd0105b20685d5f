"""`bench`: the error that each solver leaves against the time it takes, as a table and a plot."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import Unsuitable
from sceneql.files import whole
from sceneql.graph import SimulationGraph
from sceneql.report.order import observed_order
from sceneql.report.plots import error_against_time, legend
from sceneql.report.reference import reference
from sceneql.report.work_precision import Measurement, measurements, solvers, warm

CLEAR = 10.0
"""Errors count for the order where they are so many times the reference's own."""


def bench(graph: SimulationGraph, output: Path | None = None, words: Path | None = None) -> str:
    """Run every island by every solver that applies; write ``<scene>.bench.csv`` and ``.svg``; the report as text.

    ``output`` is a folder, or the files' path without extension; ``words`` a folder of the user's own words. Raises
    Unsuitable for a scene without an island, RunFailure where a reference cannot reach the end.
    """
    if not graph.islands:
        raise Unsuitable(f"nothing in {graph.name} is solved in time, so there is nothing to measure")
    catalogue = Catalogue(words)
    rows: list[Measurement] = []
    orders: dict[tuple[str, str], float | None] = {}
    lines: list[str] = []
    compile_seconds = 0.0
    for island in graph.islands:
        title = ", ".join(island.models)
        methods = solvers(graph, island, catalogue)
        compile_seconds += sum(warm(graph, island, solver) for solver in methods.values())
        truth = reference(graph, island, catalogue)
        lines += [f"{title}: errors against {truth.because} (itself good to {truth.uncertainty:.0e})"]
        for word, solver in methods.items():
            runs = list(measurements(graph, island, word, solver, truth))
            rows += runs
            orders[title, word] = _order(runs, CLEAR * truth.uncertainty, graph.settings.clock.end)
            lines += _account(runs, legend(word, orders[title, word], sum(not run.ok for run in runs)))
    table, plot = (_path(graph, output, extension) for extension in ("csv", "svg"))
    _write_csv(table, rows, orders)
    error_against_time(plot, graph.name, rows, orders)
    lines += [f"compiled in {compile_seconds:.1f} s, which is in none of the times", f"wrote {table} and {plot}"]
    return "\n".join(lines)


def _order(runs: Sequence[Measurement], floor: float, end: float) -> float | None:
    """Observed order in the mean step."""
    done = [run for run in runs if run.ok]
    return observed_order([end / run.steps for run in done], [run.error for run in done], floor)


def _account(runs: Sequence[Measurement], heading: str) -> list[str]:
    lines = [f"  {heading}"]
    for run in runs:
        setting = f"{'tolerance' if run.adaptive else 'step'} {run.setting:.3g}{'' if run.adaptive else ' s'}"
        if run.ok:
            lines.append(f"    {setting:<20} error {run.error:8.2e}  {run.seconds * 1e3:9.3f} ms  {run.steps:8d} steps")
        else:
            lines.append(f"    {setting:<20} failed {run.outcome}")
    return lines


def _path(graph: SimulationGraph, output: Path | None, extension: str) -> Path:
    stem = f"{graph.name}.bench"
    if output is None or output.is_dir():
        return (output or Path()) / f"{stem}.{extension}"
    return output.with_name(f"{output.name}.{extension}")


def _write_csv(path: Path, rows: Sequence[Measurement], orders: dict[tuple[str, str], float | None]) -> None:
    text = io.StringIO()
    writer = csv.DictWriter(text, [*(item.name for item in fields(Measurement)), "order"], lineterminator="\n")
    writer.writeheader()
    for row in rows:
        order = orders[row.island, row.solver]
        writer.writerow({**asdict(row), "order": "" if order is None else f"{order:.4f}"})
    with whole(path) as file:
        file.write(text.getvalue().encode())
