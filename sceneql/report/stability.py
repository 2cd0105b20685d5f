"""`stability`: a map of which solver is stable where, over decades of a step, a stiffness or any other value."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import asdict, fields
from pathlib import Path

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.studies import POINTS
from sceneql.failure import Unsuitable
from sceneql.files import whole
from sceneql.report.bench import write_json
from sceneql.report.page import Table, beside, file_names, write_page
from sceneql.report.plots import as_png, stability_map
from sceneql.report.stability_map import Cell, Load, cells, default_sweep
from sceneql.report.stability_sweep import Sweep, parse_sweep

LARGEST_ERROR = 0.1
"""Relative error at the end above which a run is called inaccurate: it is visible."""
LETTERS = {"stable": ".", "inaccurate": "~", "failed": "X", "skipped": " "}


def stability(
    load: Load,
    sweep: str | None = None,
    points: int | None = None,
    output: Path | None = None,
    words: Path | None = None,
    largest_error: float = LARGEST_ERROR,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> str:
    """Run every solver at every value of a sweep and write the map as CSV, JSON, SVG and HTML; returns the report text.

    ``load(patches)``: the scene with more patches; ``sweep``: text as in `parse_sweep`, by default steps around the
    bound; ``output``: a folder, or the files' path without extension. Raises Unsuitable, ScriptError.
    """
    graph = load(())
    if not graph.islands:
        raise Unsuitable(f"nothing in {graph.name} is solved in time, so nothing can be unstable")
    stem = file_names(graph, "stability", output)
    chosen = default_sweep(graph) if sweep is None else parse_sweep(sweep, points or POINTS)
    found = list(cells(load, chosen, Catalogue(words), largest_error, progress))
    if not found:
        raise Unsuitable(f"no solver that applies has a {chosen.path}")
    lines = _lines(chosen, found, largest_error)
    table, data, picture, page = (beside(stem, extension) for extension in ("csv", "json", "svg", "html"))
    _write_csv(table, found)
    write_json(data, {"scene": graph.name, "sweep": asdict(chosen), "cells": [asdict(cell) for cell in found]})
    stability_map(picture, graph.name, chosen.label, found)
    about = [graph.settings.about] if graph.settings.about else []
    caption = "Runs by solver and value"
    write_page(
        page, f"{graph.name}: stability", [*about, LEGEND.format(largest_error)], [(caption, picture)], _tables(found)
    )
    return "\n".join([*lines, f"wrote {table}, {data}, {picture}, {as_png(picture)} and {page}"])


LEGEND = (
    "A run is stable when it ends with a relative error of at most {:g}, inaccurate when the error is larger, failed "
    "when it was stopped or ran away, skipped when it would take too long. A number in the map is the power of ten of "
    "the error; a black bar stands where the step passes the bound that is known before the run."
)


def _lines(sweep: Sweep, found: Sequence[Cell], largest_error: float) -> list[str]:
    """The map as text."""
    lines = [f"{sweep.label} from {sweep.values[0]:g} to {sweep.values[-1]:g} in {len(sweep.values)} points"]
    for island in dict.fromkeys(cell.island for cell in found):
        mine = [cell for cell in found if cell.island == island]
        width = max(len(cell.solver) for cell in mine)
        lines.append(f"{island}:")
        for word in dict.fromkeys(cell.solver for cell in mine):
            row = [LETTERS[cell.outcome] for cell in mine if cell.solver == word]
            lines.append(f"  {word:<{width}}  {' '.join(row)}".rstrip())
    lines.append(f". stable, ~ inaccurate (error above {largest_error:g}), X failed, blank: skipped")
    return lines


def _tables(found: Sequence[Cell]) -> list[Table]:
    head = ("solver", "value", "step or tolerance", "outcome", "error", "bound [s]", "run time [ms]", "steps", "why")
    rows = [
        [
            (text, cell.outcome)
            for text in (
                cell.solver,
                f"{cell.value:.4g}",
                f"{cell.setting:.3g}",
                cell.outcome,
                f"{cell.error:.1e}",
                "" if cell.adaptive else f"{cell.bound:.3g}",
                f"{cell.seconds * 1e3:.3f}",
                str(cell.steps),
                cell.why,
            )
        ]
        for cell in found
    ]
    return [Table("All runs", head, rows)]


def _write_csv(path: Path, found: Sequence[Cell]) -> None:
    text = io.StringIO()
    writer = csv.DictWriter(text, [item.name for item in fields(Cell)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(cell) for cell in found)
    with whole(path) as file:
        file.write(text.getvalue().encode())
