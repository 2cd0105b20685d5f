"""The results of a study as table, map, charts and page."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from pathlib import Path

from sceneql.failure import Unsuitable
from sceneql.files import whole
from sceneql.quantities.diagnostic import suggestion
from sceneql.report.bench import write_json
from sceneql.report.page import Table, beside, file_names, write_page
from sceneql.report.plots import both, stability_map, study_errors
from sceneql.report.stability import LETTERS
from sceneql.report.stability_map import Cell
from sceneql.report.study import Load, Trial, trials


def study(
    load: Load,
    name: str | None = None,
    output: Path | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> str:
    """Run a study and write it as CSV, JSON, SVG and HTML; returns the report text.

    ``name``: that of the study, where the script has several; ``output``: a folder, or the files' path without
    extension. Raises Unsuitable, ScriptError.
    """
    graph = load(())
    known = graph.settings.studies
    if name is None and len(known) == 1:
        name = next(iter(known))
    if name is None or name not in known:
        if not known:
            raise Unsuitable(f"{graph.name} has no `studies`")
        hint = suggestion(name or "", known) or f"there are {', '.join(known)}"
        raise Unsuitable(f"which study? {hint}" if name is None else f"there is no study '{name}': {hint}")
    stem = file_names(graph, name, output)
    found = list(trials(load, name, progress))
    paths = list(known[name].sweep)
    numbered = next((k for k, value in enumerate(found[0].values) if math.isfinite(value.number)), None)
    table, data, page, errors, picture = (
        beside(stem, extension) for extension in ("csv", "json", "html", "svg", "map.svg")
    )
    _write_csv(table, paths, found)
    write_json(data, {"scene": graph.name, "script_hash": graph.script_hash, "study": name, "runs": _plain(found)})
    label = "" if numbered is None else _with_unit(paths[numbered], found[0].values[numbered].unit)
    study_errors(errors, f"{graph.name}: {name}", label, _by_rest(found, numbered))
    plots = [("Errors against run time", errors)]
    if numbered is not None:
        stability_map(picture, graph.name, label, [_cell(name, trial, numbered) for trial in found])
        plots.insert(0, ("Outcomes", picture))
    lines = [graph.settings.about] if graph.settings.about else []
    write_page(
        page, f"{graph.name}: {name}", [*lines, LEGEND.format(known[name].accuracy)], plots, [_table(paths, found)]
    )
    made = ", ".join(map(str, (table, data, *both(plots))))
    return "\n".join([*_lines(found, numbered, label, known[name].accuracy), f"wrote {made} and {page}"])


LEGEND = (
    "A run is stable when it ends with a relative error of at most {:g}, inaccurate when the error is larger, failed "
    "when it was stopped, skipped when it would take too long or cannot be compared. A number in the map is the power "
    "of ten of the error."
)


def _rest(trial: Trial, numbered: int | None) -> str:
    """Label of a run's values without the numbered one."""
    return ", ".join(value.label for k, value in enumerate(trial.values) if k != numbered) or "script"


def _by_rest(found: Sequence[Trial], numbered: int | None) -> dict[str, list[tuple[float, float, float, float]]]:
    rows: dict[str, list[tuple[float, float, float, float]]] = {}
    for trial in found:
        number = math.nan if numbered is None else trial.values[numbered].number
        rows.setdefault(_rest(trial, numbered), []).append((number, trial.error, trial.seconds, trial.median))
    return rows


def _cell(name: str, trial: Trial, numbered: int) -> Cell:
    """A run as a cell of the stability map, without a stability bound."""
    number, nan = trial.values[numbered].number, math.nan
    error, rest = trial.error, _rest(trial, numbered)
    return Cell(name, rest, number, True, nan, trial.outcome, trial.why, error, nan, trial.seconds, trial.steps)


def _lines(found: Sequence[Trial], numbered: int | None, label: str, accuracy: float) -> list[str]:
    """The outcomes as text: a row for each combination, a column for each number."""
    rows: dict[str, list[Trial]] = {}
    for trial in found:
        rows.setdefault(_rest(trial, numbered), []).append(trial)
    width = max(map(len, rows))
    if numbered is None:
        return [f"{rest:<{width}}  {_told(runs[0])}" for rest, runs in rows.items()]
    ends = [runs.values[numbered].label for runs in (found[0], found[-1])]
    lines = [f"{label} from {ends[0]} to {ends[1]}"]
    lines += [
        f"{rest:<{width}}  {' '.join(LETTERS[run.outcome] for run in runs)}".rstrip() for rest, runs in rows.items()
    ]
    return [*lines, f". stable, ~ inaccurate (error above {accuracy:g}), X failed, blank: skipped"]


def _told(trial: Trial) -> str:
    if trial.outcome in ("failed", "skipped"):
        return f"{trial.outcome}: {trial.why}"
    return f"{trial.outcome}, error {trial.error:.2e}, {trial.seconds * 1e3:.3f} ms, {trial.steps} steps"


def _table(paths: Sequence[str], found: Sequence[Trial]) -> Table:
    more = list(dict.fromkeys(name for trial in found for name in trial.measured))
    head = (*paths, "outcome", "error", "run time [ms]", "median [ms]", "steps", "evaluations", *more, "why")
    rows = [
        [
            (text, trial.outcome)
            for text in (
                *(value.label for value in trial.values),
                trial.outcome,
                f"{trial.error:.2e}",
                f"{trial.seconds * 1e3:.3f}",
                f"{trial.median * 1e3:.3f}",
                str(trial.steps),
                str(trial.evaluations),
                *(f"{trial.measured.get(name, math.nan):.6g}" for name in more),
                trial.why,
            )
        ]
        for trial in found
    ]
    return Table("All runs", head, rows)


def _plain(found: Sequence[Trial]) -> list[dict[str, object]]:
    return [
        {
            "values": {value.patch[0]: value.label for value in trial.values},
            **{
                name: getattr(trial, name)
                for name in ("outcome", "why", "error", "seconds", "median", "steps", "evaluations")
            },
            "measured": trial.measured,
        }
        for trial in found
    ]


def _write_csv(path: Path, paths: Sequence[str], found: Sequence[Trial]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    more = list(dict.fromkeys(name for trial in found for name in trial.measured))
    writer.writerow([*paths, "outcome", "error", "seconds", "median", "steps", "evaluations", *more, "why"])
    for trial in found:
        told = [value.label if math.isnan(value.number) else repr(value.number) for value in trial.values]
        costs = [trial.outcome, trial.error, trial.seconds, trial.median, trial.steps, trial.evaluations]
        writer.writerow([*told, *costs, *(trial.measured.get(name, math.nan) for name in more), trial.why])
    with whole(path) as file:
        file.write(text.getvalue().encode())


def _with_unit(path: str, unit: str) -> str:
    return f"{path} [{unit}]" if unit else path
