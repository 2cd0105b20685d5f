"""`bench`: error against run time, of each solver and of each way to draw a surface."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import LimitRefused, RunFailure, Unsuitable
from sceneql.files import whole
from sceneql.graph import SimulationGraph
from sceneql.kinds import Solver
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.bench_elements import element_section, takes_little
from sceneql.report.bench_grids import GridSection, grid_section
from sceneql.report.bench_surfaces import Section, surface_section
from sceneql.report.energy_drift import Drift, drift
from sceneql.report.order import observed_order
from sceneql.report.page import Table, beside, file_names, write_page
from sceneql.report.plots import both, drift_against_time, error_against_step, error_against_time, legend
from sceneql.report.reference import reference
from sceneql.report.surface_measures import pictured
from sceneql.report.work_precision import Measurement, Reference, among, known, measurements, solvers, warm

CLEAR = 10.0
"""An error counts for the observed order if it is at least this multiple of the reference's own error."""
NO_REFERENCE = (
    "solvers are not compared, since runs at tight tolerances would take minutes: they are with larger elements, "
    "as by --set models.NAME.elastic.spacing=..., or a shorter clock"
)
ASKED = (1e-3, 1e-6, 1e-9)
"""Relative errors for which the cheapest solver is named by default."""

Orders = dict[tuple[str, str], float | None]


def bench(
    graph: SimulationGraph,
    output: Path | None = None,
    words: Path | None = None,
    asked: float | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
    chosen: Sequence[str] = (),
    say: Callable[[str], None] = lambda line: None,
) -> str:
    """Run every island by every applicable solver, and measure implicit surfaces by rays and meshes.

    Returns the report text. ``output``: a folder, or the files' path without extension. Written are CSV and JSON with
    all runs, SVGs (and PNGs) of the error against run time and step and of the energy drift, and HTML with all of it.
    Solids of elements come first (``elements``): by kinds of elements and spacings, with orders. Fields are run on
    several grids (``grids``), on these by all schemes (``schemes``), and their systems are solved by every linear
    solver (``linear``). Implicit surfaces of the first picture at its start, in several sizes, have files of their own
    (``rays``, ``meshes``, ``surfaces``). ``say`` gets lines as soon as runs end; ``words``: a folder of the user's own
    words; ``asked``: the relative error for which the cheapest solver is named; ``chosen``: the solvers to run, empty
    for all. Raises Unsuitable for a scene without islands and implicit surfaces and for solvers that do not apply,
    RunFailure where no reference reaches the end.
    """
    frames = pictured(graph)
    if not graph.islands and not frames:
        raise Unsuitable(
            f"nothing in {graph.name} is solved in time or drawn as an implicit surface, so there is nothing to measure"
        )
    stem = file_names(graph, "bench", output)
    catalogue = Catalogue(words)
    known(chosen, catalogue)
    rows: list[Measurement] = []
    drifts: list[Drift] = []
    orders: Orders = {}
    schemes = among(chosen, {", ".join(one.models): solvers(graph, one, catalogue) for one in graph.islands})
    lines: list[str] = []
    summary: list[str] = []
    compile_seconds = 0.0
    on_elements = element_section(graph, stem, say)
    if on_elements is not None:
        lines += on_elements.lines
        summary += [line for line in on_elements.lines if not line.startswith(" ")]
    for island in graph.islands:
        title = ", ".join(island.models)
        applying = schemes[title]
        if not applying:
            lines.append(f"{title}: none of {', '.join(chosen)} applies")
            continue
        if cast(Solver, graph.tasks[island.solver].kind).static:
            word = graph.tasks[island.solver].word
            lines.append(f"{title}: {word} finds rests, and takes no steps in time whose lengths could be compared")
            summary.append(lines[-1])
            continue
        if on_elements is not None and not takes_little(on_elements, graph, island):
            lines.append(f"{title}: {NO_REFERENCE}")
            summary.append(lines[-1])
            continue
        truth = reference(graph, island, catalogue)
        lines.append(f"{title}: errors against {truth.because} (itself good to {truth.uncertainty:.0e})")
        summary.append(lines[-1])
        say(lines[-1])
        for done, (word, solver) in enumerate(applying.items()):
            progress(done, len(applying))
            try:
                compile_seconds += warm(graph, island, solver)
                runs = list(measurements(graph, island, word, solver, truth))
                moved = drift(graph, island, word, solver)
            except (ValueError, TypeError, LimitRefused, ScriptError, RunFailure) as refused:
                lines.append(f"  {word} does not apply: {refused}")
                continue
            rows += runs
            drifts += [moved] if moved is not None else []
            orders[title, word] = _order(runs, CLEAR * truth.uncertainty, graph.settings.clock.end)
            told = _account(runs, legend(word, orders[title, word], sum(not run.ok for run in runs)))
            say("\n".join(told))
            lines += told
        named = cheapest_lines([row for row in rows if row.island == title], truth, asked)
        lines += named
        summary += named
    if rows:
        lines.append(f"compiled in {compile_seconds:.1f} s, which is in none of the times")
        summary.append(lines[-1])
    section = surface_section(frames, graph.name, stem) if frames else None
    if section is not None:
        lines += section.lines
        summary.append(section.lines[0])
    on_grids = grid_section(graph, stem, schemes)
    if on_grids is not None:
        lines += on_grids.lines
        summary += [line for line in on_grids.lines if not line.startswith(" ")]
    parts = [one for one in (on_elements, section) if one is not None]
    made = _write(stem, graph, rows, orders, drifts, [graph.settings.about, *summary], parts, on_grids)
    return "\n".join([*lines, *_drift_lines(drifts), f"wrote {', '.join(map(str, made))}"])


def cheapest(rows: Sequence[Measurement], asked: float) -> tuple[str, float] | None:
    """The solver that reaches a relative error in the least time, and that time [s], interpolated between its runs.

    None where no run is that accurate.
    """
    found: dict[str, float] = {}
    for word in dict.fromkeys(row.solver for row in rows):
        done = [row for row in rows if row.solver == word and row.ok]
        times = [row.seconds for row in done if row.error <= asked]
        for a, b in pairwise(done):
            low, high = sorted((a, b), key=lambda row: row.error)
            if 0.0 < low.error <= asked < high.error:
                part = math.log(asked / high.error) / math.log(low.error / high.error)
                times.append(math.exp((1 - part) * math.log(high.seconds) + part * math.log(low.seconds)))
        if times:
            found[word] = min(times)
    return min(found.items(), key=lambda pair: pair[1], default=None)


def cheapest_lines(rows: Sequence[Measurement], truth: Reference, asked: float | None) -> list[str]:
    """Lines that name the cheapest solver for the error ``asked``, or for each of ASKED."""
    lines = []
    for error in ASKED if asked is None else (asked,):
        best = cheapest(rows, error)
        if best is not None and error > truth.uncertainty:
            lines.append(f"cheapest for an error of {error:.0e}: {best[0]}, {best[1] * 1e3:.3g} ms")
        elif asked is not None:
            lines.append(f"an error of {error:.0e} is not reached, or below what the reference can tell")
    return lines


def _order(runs: Sequence[Measurement], floor: float, end: float) -> float | None:
    """Observed order of convergence in the mean step; None where there is none."""
    done = [run for run in runs if run.ok]
    return observed_order([end / run.steps for run in done], [run.error for run in done], floor)


def _account(runs: Sequence[Measurement], heading: str) -> list[str]:
    lines = [f"  {heading}"]
    for run in runs:
        setting = f"{'tolerance' if run.adaptive else 'step'} {run.setting:.3g}{'' if run.adaptive else ' s'}"
        of = f"  in {run.worst}" if run.worst else ""
        if run.ok:
            lines.append(
                f"    {setting:<20} error {run.error:8.2e}  {run.seconds * 1e3:9.3f} ms  {run.steps:8d} steps{of}"
            )
        else:
            lines.append(f"    {setting:<20} failed {run.outcome}")
    return lines


def _drift_lines(drifts: Sequence[Drift]) -> list[str]:
    return [
        f"{one.island} by {one.solver} at {one.setting:.3g}: energy drifts by {max(map(abs, one.changes)):.1e} at most"
        + ("" if math.isnan(one.momentum) else f", momentum by {one.momentum:.1e}")
        for one in drifts
        if one.changes
    ]


def _write(
    stem: Path,
    graph: SimulationGraph,
    rows: Sequence[Measurement],
    orders: Orders,
    drifts: Sequence[Drift],
    summary: Sequence[str],
    sections: Sequence[Section],
    on_grids: GridSection | None,
) -> list[Path]:
    """Write all files of the report."""
    table, data, time, step, moved, page = (
        beside(stem, extension) for extension in ("csv", "json", "svg", "step.svg", "drift.svg", "html")
    )
    files: list[Path] = []
    plots: list[tuple[str, Path]] = []
    tables: list[Table] = []
    if rows:
        _write_csv(table, rows, orders)
        error_against_time(time, graph.name, rows, orders)
        error_against_step(step, graph.name, rows, orders, graph.settings.clock.end)
        plots += [("Error against run time", time), ("Error against step", step)]
        tables.append(_table(rows))
        files.append(table)
    _write_json(data, graph, rows, orders, drifts, sections, on_grids)
    if on_grids is not None:
        plots += on_grids.plots
        tables += on_grids.tables
        files += on_grids.files
    if drifts:
        drift_against_time(moved, graph.name, drifts)
        plots.append(("Drift of energy", moved))
        tables.append(_drift_table(drifts))
    files += [data, *both(plots)]
    for section in sections:
        plots += section.plots
        tables += section.tables
        files += section.files
    lines = [line for line in (*summary, *_drift_lines(drifts)) if line]
    write_page(page, f"{graph.name}: error against run time", lines, plots, tables)
    return [*files, page]


def _table(rows: Sequence[Measurement]) -> Table:
    head = (
        "solver", "step or tolerance", "error", "run time [ms]", "median [ms]", "steps", "evaluations",
        "outcome",
    )  # fmt: skip
    cells = [
        (row.solver, f"{row.setting:.3g}", f"{row.error:.2e}", *_times(row), *_counts(row), row.outcome) for row in rows
    ]
    styles = ["" if row.ok else "failed" for row in rows]
    return Table(
        "All runs", head, [[(text, style) for text in line] for line, style in zip(cells, styles, strict=True)]
    )


def _times(row: Measurement) -> tuple[str, str]:
    return f"{row.seconds * 1e3:.3f}", f"{row.median * 1e3:.3f}"


def _drift_table(drifts: Sequence[Drift]) -> Table:
    """Table of relative changes of energy (at the end, and largest), and of momentum where it is conserved."""
    head = ("island", "solver", "step or tolerance", "energy at the end", "energy at most", "momentum at most", "")
    rows = [
        (
            one.island,
            one.solver,
            f"{one.setting:.3g}",
            f"{one.changes[-1]:.2e}",
            f"{max(one.changes, key=abs):.2e}",
            "not conserved" if math.isnan(one.momentum) else f"{one.momentum:.2e}",
            "driven" if one.driven else "",
        )
        for one in drifts
        if one.changes
    ]
    return Table("Drifts, relative", head, [[(text, "") for text in row] for row in rows])


def _counts(row: Measurement) -> tuple[str, str]:
    return str(row.steps), str(row.evaluations)


def _write_csv(path: Path, rows: Sequence[Measurement], orders: Orders) -> None:
    text = io.StringIO()
    writer = csv.DictWriter(text, [*(item.name for item in fields(Measurement)), "order"], lineterminator="\n")
    writer.writeheader()
    for row in rows:
        order = orders[row.island, row.solver]
        writer.writerow({**asdict(row), "order": "" if order is None else f"{order:.4f}"})
    with whole(path) as file:
        file.write(text.getvalue().encode())


def _write_json(
    path: Path,
    graph: SimulationGraph,
    rows: Sequence[Measurement],
    orders: Orders,
    drifts: Sequence[Drift],
    sections: Sequence[Section],
    on_grids: GridSection | None,
) -> None:
    found: dict[str, Any] = {
        "scene": graph.name,
        "script_hash": graph.script_hash,
        "end": graph.settings.clock.end,
        "runs": [asdict(row) for row in rows],
        "orders": [{"island": i, "solver": s, "order": order} for (i, s), order in orders.items()],
        "drifts": [asdict(one) for one in drifts],
    }
    for section in sections:
        found |= section.data
    if on_grids is not None:
        found["fields"] = on_grids.data
    write_json(path, found)


def write_json(path: Path, found: Mapping[str, Any]) -> None:
    """Write plain data as JSON, with null for numbers that are not finite."""
    with whole(path) as file:
        file.write(json.dumps(_sayable(found), indent=1, allow_nan=False).encode())


def _sayable(data: Any) -> Any:
    if isinstance(data, Mapping):
        return {key: _sayable(item) for key, item in data.items()}
    if isinstance(data, list | tuple):
        return [_sayable(item) for item in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data
