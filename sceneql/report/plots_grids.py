"""Plots of benchmarks of fields on grids as SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sceneql.report.bench_schemes import front
from sceneql.report.curve_ends import label_ends
from sceneql.report.plots import MARKS, SMALLEST, figure_at, panel

if TYPE_CHECKING:
    from sceneql.report.bench_methods import MethodRun
    from sceneql.report.bench_schemes import SchemeRun
    from sceneql.report.element_runs import ElementRun
    from sceneql.report.grid_runs import GridRun, LinearRun


def _panels(figure: Any, title: str, rows: Sequence[Any]) -> Any:
    """(axes, rows) of a panel for each island."""
    islands = list(dict.fromkeys(row.island for row in rows))
    for k, island in enumerate(islands):
        axes = panel(figure, len(islands), k)
        axes.set_title(f"{title}: {island}")
        axes.grid(True, which="major", alpha=0.3)
        yield axes, [row for row in rows if row.island == island]


def _size(rows: Sequence[Any]) -> tuple[float, float]:
    return 9.0, 4.8 * len({row.island for row in rows})


def schemes_against_time(path: Path, title: str, runs: Sequence[SchemeRun]) -> None:
    """Write an SVG: error of space and time over run time [s]; a dot a run, and a line through the best of each scheme.

    A dot's size is that of the cells; errors larger than the field itself are not drawn.
    """
    with figure_at(path, _size(runs)) as figure:
        for axes, mine in _panels(figure, title, runs):
            axes.set(xscale="log", yscale="log", xlabel="run time [s]", ylabel="error of space and time, rms")
            cells = sorted({run.cell for run in mine})
            for word, mark in zip(dict.fromkeys(run.solver for run in mine), cycle(MARKS), strict=False):
                own = [run for run in mine if run.solver == word and run.error < 1.0]
                best = front(own)
                (line,) = axes.plot([run.seconds for run in best], [run.error for run in best], lw=1.2, label=word)
                axes.scatter(
                    [run.seconds for run in own],
                    [run.error for run in own],
                    s=[12 + 14 * cells.index(run.cell) for run in own],
                    marker=mark, color=line.get_color(), alpha=0.6, linewidths=0,
                )  # fmt: skip
            label_ends(axes)


def error_against_cell(path: Path, title: str, runs: Sequence[GridRun], orders: Mapping[str, float | None]) -> None:
    """Write an SVG: error of space alone over the side of a cell [m]; the slope is the order, which is written out."""
    with figure_at(path, _size(runs)) as figure:
        for axes, mine in _panels(figure, title, runs):
            axes.set(xscale="log", yscale="log", xlabel="cell [m]", ylabel="error of space, rms")
            order = orders[mine[0].island]
            text = "no order seen" if order is None else f"order {order:.2f}"
            axes.plot([run.cell for run in mine], [max(run.error, SMALLEST) for run in mine], "o-", ms=4, label=text)
            label_ends(axes)


def methods_against_time(path: Path, title: str, runs: Sequence[MethodRun]) -> None:
    """Write an SVG: error of space over run time [s] with the set-up, a line a method, a mark a spacing."""
    with figure_at(path, _size(runs)) as figure:
        for axes, mine in _panels(figure, title, runs):
            axes.set(xscale="log", yscale="log", xlabel="run time with set-up [s]", ylabel="error of space, rms")
            for method, mark in zip(dict.fromkeys(run.method for run in mine), cycle(MARKS), strict=False):
                own = [run for run in mine if run.method == method]
                times, errors = [run.seconds + run.setup for run in own], [max(run.error, SMALLEST) for run in own]
                axes.plot(times, errors, marker=mark, ms=5, lw=1.2, label=method)
            label_ends(axes)


def elements_against_time(path: Path, title: str, runs: Sequence[ElementRun]) -> None:
    """Write an SVG: error over run time [s] with the set-up, a panel a quantity, a line an element."""
    quantities = list(dict.fromkeys((run.island, run.quantity) for run in runs))
    with figure_at(path, (9.0, 4.8 * len(quantities))) as figure:
        for k, (island, quantity) in enumerate(quantities):
            axes = panel(figure, len(quantities), k)
            axes.set_title(f"{title}: {island}, {quantity}")
            axes.grid(True, which="major", alpha=0.3)
            axes.set(xscale="log", yscale="log", xlabel="run time with set-up [s]", ylabel="relative error")
            mine = [run for run in runs if (run.island, run.quantity) == (island, quantity)]
            for element, mark in zip(dict.fromkeys(run.element for run in mine), cycle(MARKS), strict=False):
                own = [run for run in mine if run.element == element]
                times, errors = [run.seconds + run.setup for run in own], [max(run.error, SMALLEST) for run in own]
                axes.plot(times, errors, marker=mark, ms=5, lw=1.2, label=element)
            label_ends(axes)


def residuals(path: Path, title: str, runs: Sequence[LinearRun]) -> None:
    """Write an SVG: the residual over the iterations of one step, a line a linear solver."""
    with figure_at(path, _size(runs)) as figure:
        for axes, mine in _panels(figure, title, runs):
            step = f"one step of {mine[0].step:.3g} s by implicit_euler"
            axes.set(xscale="symlog", yscale="log", xlabel=f"iterations, {step}", ylabel="residual, of the first")
            for run in mine:
                if run.residuals:
                    each = run.iterations / max(1, len(run.residuals) - 1)
                    shares = [max(share, SMALLEST) for share in run.residuals]
                    text = f"{run.linear}, {run.seconds * 1e3:.3g} ms"
                    axes.plot([k * each for k in range(len(shares))], shares, ".-", lw=1.2, label=text)
                else:
                    axes.plot([], [], " ", label=f"{run.linear}, at once, {run.seconds * 1e3:.3g} ms")
            label_ends(axes)
