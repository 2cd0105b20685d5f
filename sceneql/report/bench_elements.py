"""The part of `bench` on solids: kinds of elements over spacings, errors and their orders, and run times."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sceneql.graph import Island, SimulationGraph
from sceneql.report.bench_surfaces import Section, table_of, write_rows
from sceneql.report.element_runs import ElementRun, Solved, best_of, between, element_runs, relative, solids
from sceneql.report.page import beside
from sceneql.report.plots import both
from sceneql.report.plots_grids import elements_against_time

MOVES = "displacements"
LITTLE = 0.5
"""Time of a run [s] up to which hundreds of them, by all solvers, are worth their while."""
CLEAR = 2.0
"""An error counts for an order if it is at least this multiple of the reference's own."""
APART, ALIKE = 1.15, 1.15
"""Factor by which elements are smaller at least where an order is told, and by which it may differ between sides."""


def element_section(
    graph: SimulationGraph, stem: Path, say: Callable[[str], None] = lambda line: None
) -> Section | None:
    """Run the solids of a scene by kinds of elements and spacings, and write files beside ``stem``.

    None where there are none that may be made of other elements. ``say`` gets a line for each run as soon as it ends.
    """
    rows: list[ElementRun] = []
    lines: list[str] = []
    for island in graph.islands:
        if not solids(graph, island):
            continue
        title, word = ", ".join(island.models), graph.tasks[island.solver].word
        say(f"{title} by elements and spacings, by {word}:")
        missed: list[str] = []

        def refused(line: str, missed: list[str] = missed) -> None:
            missed.append(line)
            say(f"  {line}")

        runs: list[Solved] = []
        for one in element_runs(graph, island, refused):
            runs.append(one)
            say(f"  {_head(one)}{''.join(f'  {name} {_largest(value):.6g}' for name, value in one.watched.items())}")
        found, told = _compared(graph, island, runs)
        rows += found
        lines += [f"{title} by elements and spacings, by {word}, compiled in {sum(r.compiling for r in runs):.1f} s:"]
        lines += [*told, *(f"  {line}" for line in missed)]
    if not lines:
        return None
    if not rows:
        return Section(lines, [], [], [], {"elements": []})
    path, plot = beside(stem, "elements.csv"), beside(stem, "elements.svg")
    write_rows(path, ElementRun, rows)
    elements_against_time(plot, graph.name, rows)
    plots = [("Error against run time, by elements", plot)]
    data = {"elements": [asdict(row) for row in rows]}
    return Section(lines, [table_of("Elements over spacings", ElementRun, rows)], plots, [path, *both(plots)], data)


def takes_little(section: Section, graph: SimulationGraph, island: Island) -> bool:
    """Whether an island has no solids, or a run of it as the script has it took little time."""
    title = ", ".join(island.models)
    for name in solids(graph, island):
        kind: Any = graph.tasks[name].kind
        own = [one for one, other in kind.by_methods().items() if other.chosen_element() is kind.chosen_element()]
        return any(
            row["island"] == title and row["element"] in own and row["spacing"] <= 1.001 * kind.spaced()
            and row["seconds"] + row["setup"] < LITTLE
            for row in section.data["elements"]
        )  # fmt: skip
    return True


def _compared(graph: SimulationGraph, island: Island, runs: Sequence[Solved]) -> tuple[list[ElementRun], list[str]]:
    """The errors of all quantities against exact values or the finest run, and lines that tell them."""
    best = best_of(graph, solids(graph, island)[0])
    own = [run for run in runs if run.element == best]
    if len(own) < 2:
        return [], [f"  fewer than two runs by {best}, so that there is nothing to compare with"]
    reference, before = own[-1], own[-2]
    title = ", ".join(island.models)
    rows: list[ElementRun] = []
    lines: list[str] = []
    for name in (MOVES, *reference.watched):
        exact = reference.right.get(name)
        doubt = (
            0.0 if exact is not None else _error(before, reference, name) * (reference.spacing / before.spacing) ** 2
        )
        truth = f"exact, {_largest(exact):.6g}" if exact is not None else f"{best} at {reference.spacing:.4g} m"
        good = "" if exact is not None else f", itself good to about {doubt:.0e}"
        lines.append(f"  {name} beside {truth}{good}:")
        shown = [one for one in runs if exact is not None or one is not reference]
        mine = list(_rows(title, name, shown, reference, doubt))
        rows += mine
        lines += [_line(one, row) for one, row in zip(shown, mine, strict=True)]
    return rows, lines


def _rows(title: str, name: str, runs: Sequence[Solved], reference: Solved, doubt: float) -> Iterator[ElementRun]:
    """The rows of one quantity, with the order between each run and a coarser one of its element."""
    coarser: list[tuple[Solved, ElementRun]] = []
    for one in runs:
        error, order = _error(one, reference, name), math.nan
        known = [(_finer(one, other), row.error) for other, row in reversed(coarser) if other.element == one.element]
        times, before = next(((times, error) for times, error in known if times), (0.0, 0.0))
        if times and min(error, before) > CLEAR * doubt:
            order = math.log(before / error) / math.log(times)
        value = _largest(one.samples[1]) if name == MOVES else _largest(one.watched[name])
        row = ElementRun(
            title, name, one.element, one.spacing, one.unknowns, value, error, order, one.seconds, one.setup,
            one.compiling,
        )  # fmt: skip
        coarser.append((one, row))
        yield row


def _finer(one: Solved, other: Solved) -> float:
    """By which factor the elements of a run are smaller; 0 where they are about as large, or of another shape.

    Counts of cells along short sides round alike, so that only the long ones may change.
    """
    times = [b / a for a, b in zip(one.sides, other.sides, strict=True)]
    if min(times) < APART or max(times) > ALIKE * min(times):
        return 0.0
    return math.prod(times) ** (1.0 / len(times))


def _error(one: Solved, reference: Solved, name: str) -> float:
    if name == MOVES:
        return between(one, reference)
    return relative(one.watched[name], reference.right.get(name, reference.watched[name]))


def _largest(value: Any) -> float:
    import numpy as np

    flat = np.ravel(value)
    return float(flat[np.argmax(np.abs(flat))]) if len(flat) else math.nan


def _head(one: Solved) -> str:
    return (
        f"{one.element:<7} spacing {one.spacing:<9.4g} m {one.unknowns:7d} unknowns  {_time(one)}"
        f"  compiled in {one.compiling:4.1f} s"
    )


def _time(one: Solved) -> str:
    return f"{(one.seconds + one.setup) * 1e3:9.1f} ms, steps {one.seconds * 1e3:9.1f} ms"


def _line(one: Solved, row: ElementRun) -> str:
    order = "" if math.isnan(row.order) else f"  order {row.order:5.2f}"
    return (
        f"    {one.element:<7} spacing {one.spacing:<9.4g} m {one.unknowns:7d} unknowns  error {row.error:8.2e}"
        f"  {_time(one)}{order}"
    )
