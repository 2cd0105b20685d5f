"""Plots of benchmarks and of stability as SVG, with a PNG beside each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sceneql.files import whole
from sceneql.report.curve_ends import band, label_ends, repeats

if TYPE_CHECKING:
    from sceneql.report.energy_drift import Drift
    from sceneql.report.stability_map import Cell
    from sceneql.report.surface_measures import MeshRun, RayRun
    from sceneql.report.work_precision import Measurement

MARKS = "osD^vP*X<>"
COLORS = {"stable": "#8fd0a8", "inaccurate": "#f3d06b", "failed": "#c8553d", "skipped": "#e4e4e4"}
"""Colors of the outcomes of runs, which differ in lightness, too."""
DOTS = 150
"""Resolution of PNGs [dots per inch]."""
PLAIN = 1e-3, 1e4
"""Numbers between these are written without powers of ten."""
SMALLEST = 1e-17
"""Smallest change that is drawn."""


@contextmanager
def figure_at(path: Path, size: tuple[float, float]) -> Iterator[Any]:
    """Context manager: a figure that is written as SVG, and as PNG beside it, when the block ends."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    # A fixed salt and no date: the same measurements make the same file.
    with rc_context({"svg.hashsalt": "sceneql", "svg.fonttype": "none"}):
        figure = Figure(figsize=size, layout="constrained")
        yield figure
        with whole(path) as file:
            figure.savefig(file, format="svg", metadata={"Date": None})
        with whole(as_png(path)) as file:
            figure.savefig(file, format="png", metadata={"Software": None}, dpi=DOTS)


def as_png(svg: Path) -> Path:
    """The PNG beside an SVG."""
    return svg.with_suffix(".png")


def both(plots: Sequence[tuple[str, Path]]) -> list[Path]:
    """The files of plots (caption, SVG): each SVG and its PNG."""
    return [path for _, svg in plots for path in (svg, as_png(svg))]


def error_against_time(
    path: Path, title: str, rows: Sequence[Measurement], orders: Mapping[tuple[str, str], float | None]
) -> None:
    """Write an SVG with a panel for each island: relative error over run time [s], a line for each solver.

    The label at a line's end tells the order, from ``orders`` by (island, solver), and the number of failed runs. Bands
    reach to the median of repeated runs.
    """
    _errors(path, title, rows, orders, "run time [s]", lambda row: row.seconds, lambda row: row.median)


def error_against_step(
    path: Path, title: str, rows: Sequence[Measurement], orders: Mapping[tuple[str, str], float | None], end: float
) -> None:
    """As `error_against_time` over the mean step [s]: the slope is the order."""
    _errors(path, title, rows, orders, "mean step [s]", lambda row: end / row.steps)


def _errors(
    path: Path,
    title: str,
    rows: Sequence[Measurement],
    orders: Mapping[tuple[str, str], float | None],
    label: str,
    place: Callable[[Measurement], float],
    farthest: Callable[[Measurement], float] | None = None,
) -> None:
    islands = list(dict.fromkeys(row.island for row in rows))
    with figure_at(path, (9.0, 4.8 * len(islands))) as figure:
        for k, island in enumerate(islands):
            axes = panel(figure, len(islands), k)
            logarithmic(axes)
            axes.set(xlabel=label, ylabel="relative error at the end", title=f"{title}: {island}")
            mine = [row for row in rows if row.island == island]
            medians = []
            for solver, mark in zip(dict.fromkeys(row.solver for row in mine), cycle(MARKS), strict=False):
                runs = [row for row in mine if row.solver == solver]
                done = [row for row in runs if row.ok and row.error > 0.0]
                text = legend(solver, orders[island, solver], sum(not row.ok for row in runs))
                places, errors = [place(row) for row in done], [row.error for row in done]
                (line,) = axes.plot(places, errors, marker=mark, ms=4, label=text)
                if farthest is not None:
                    medians.append((line, [farthest(row) for row in done]))
            label_ends(axes)
            for line, median in medians:
                band(axes, line, median)


def surface_errors(path: Path, title: str, rays: Sequence[RayRun], meshes: Sequence[MeshRun]) -> None:
    """Write an SVG: wrong pixels and depth error of rays over run time [s]; errors of each mesh over cell size [m]."""
    named = list(dict.fromkeys(mesh.name for mesh in meshes))
    with figure_at(path, (9.0, 4.2 * (2 + len(named)))) as figure:
        for k, label in enumerate(("share of wrong pixels (none: a tenth of one)", "mean error of depth [m]")):
            axes = figure.add_subplot(2 + len(named), 1, k + 1)
            logarithmic(axes)
            axes.set(xlabel="run time [s]", ylabel=label, title=title)
            ways = dict.fromkeys((run.renderer, run.width, run.height) for run in rays)
            for (renderer, width, height), mark in zip(ways, cycle(MARKS), strict=False):
                mine = [run for run in rays if (run.renderer, run.width) == (renderer, width)]
                wrong = [max(run.wrong, 0.1) / max(run.pixels, 1) for run in mine]
                errors = [wrong, [max(run.depth_error, SMALLEST) for run in mine]][k]
                axes.plot(
                    [run.seconds for run in mine], errors, marker=mark, ms=4, label=f"{renderer}, {width} x {height}"
                )
            label_ends(axes)
        for k, name in enumerate(named):
            axes = figure.add_subplot(2 + len(named), 1, 3 + k)
            logarithmic(axes)
            axes.set(xlabel="cell [m]", ylabel="error", title=f"{title}: mesh of {name}")
            own = [mesh for mesh in meshes if mesh.name == name]
            cells = [mesh.cell for mesh in own]
            axes.plot(cells, [mesh.hausdorff for mesh in own], marker="o", ms=4, label="Hausdorff distance [m]")
            axes.plot(cells, [mesh.volume_error for mesh in own], marker="s", ms=4, label="volume, relative")
            axes.plot(cells, [mesh.area_error for mesh in own], marker="D", ms=4, label="area, relative")
            label_ends(axes)


def study_errors(
    path: Path, title: str, label: str, rows: Mapping[str, Sequence[tuple[float, float, float, float]]]
) -> None:
    """Write an SVG of a study: errors over run time [s], and over the swept number, if any.

    ``rows``: by the other values, (number, error, seconds, median of repeats) of each run that reached its end;
    ``label``: that of the number.
    """
    numbered = any(math.isfinite(number) for runs in rows.values() for number, *_ in runs)
    with figure_at(path, (9.0, 9.6 if numbered else 4.8)) as figure:
        for k, (column, text) in enumerate([(2, "run time [s]"), (0, label)][: 2 if numbered else 1]):
            axes = panel(figure, 2 if numbered else 1, k)
            logarithmic(axes)
            axes.set(xlabel=text, ylabel="relative error", title=title)
            medians = []
            for (name, runs), mark in zip(rows.items(), cycle(MARKS), strict=False):
                done = [run for run in runs if math.isfinite(run[1])]
                style = "-" if column == 0 else "none"  # points of harder and harder problems are no line over run time
                places, errors = [run[column] for run in done], [max(run[1], SMALLEST) for run in done]
                (line,) = axes.plot(places, errors, linestyle=style, marker=mark, ms=4, label=name)
                medians.append((line, [run[3] for run in done]))
            label_ends(axes)
            for line, median in medians if column == 2 else []:
                repeats(axes, line, median)


def panel(figure: Any, count: int, k: int) -> Any:
    """Axes of panel ``k`` of ``count``, with a color cycle for many solvers."""
    from matplotlib import colormaps

    axes = figure.add_subplot(count, 1, k + 1)
    axes.set_prop_cycle(color=[colormaps["tab20"](2 * k % 20 + k // 10) for k in range(20)])  # the dark ones first
    return axes


def logarithmic(axes: Any) -> None:
    """Logarithmic scales on both axes; within two decades the x axis is labeled at 1, 2 and 5."""
    from matplotlib.ticker import LogFormatterSciNotation, LogLocator

    class Plain(LogFormatterSciNotation):
        """Numbers as they are where all of the axis has few digits: 20, not 2 x 10^1."""

        def __call__(self, x: float, pos: Any = None) -> str:
            text: str = super().__call__(x, pos)
            low, high = axes.xaxis.get_view_interval()
            return f"{x:g}" if text and PLAIN[0] <= low and high <= PLAIN[1] else text

    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_major_formatter(Plain())
    axes.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    axes.xaxis.set_minor_formatter(Plain(minor_thresholds=(2.0, 2.0)))
    axes.grid(True, which="major", alpha=0.3)


def legend(solver: str, order: float | None, failed: int) -> str:
    """Legend text of a solver: ``rk4, order 4.0, 2 failed``."""
    parts = [solver, "no order seen" if order is None else f"order {order:.1f}"]
    return ", ".join([*parts, f"{failed} failed"] if failed else parts)


def drift_against_time(path: Path, title: str, drifts: Sequence[Drift]) -> None:
    """Write an SVG with a panel for each island: relative change of energy over time [s], a line for each solver."""
    islands = list(dict.fromkeys(drift.island for drift in drifts))
    with figure_at(path, (9.0, 4.8 * len(islands))) as figure:
        for k, island in enumerate(islands):
            axes = panel(figure, len(islands), k)
            axes.set(yscale="log", xlabel="time [s]", ylabel="relative change of energy")
            axes.set_title(f"{title}: {island}")
            axes.grid(True, which="major", alpha=0.3)
            for drift in drifts:
                if drift.island == island:
                    changes = [max(abs(change), SMALLEST) for change in drift.changes[1:]]
                    axes.plot(drift.times[1:], changes, lw=1, label=f"{drift.solver}, {drift.setting:.3g}")
            label_ends(axes)


def _tick(value: float) -> str:
    """A number in three digits, or in as many as stand before its point: 0.0316, 12.5, 4670."""
    return f"{value:.0f}" if 1e3 <= value < 1e6 else f"{value:.3g}"


def stability_map(path: Path, title: str, label: str, cells: Sequence[Cell]) -> None:
    """Write an SVG with a panel for each island: a row for each solver, a column for each value, colored by outcome.

    A cell shows the power of ten of its error; a bar stands where the step exceeds the bound known before the run.
    """
    from matplotlib.patches import Patch, Rectangle

    islands = list(dict.fromkeys(cell.island for cell in cells))
    values = sorted({cell.value for cell in cells})
    most = max(len({cell.solver for cell in cells if cell.island == island}) for island in islands)
    with figure_at(path, (2.2 + 0.55 * len(values), len(islands) * (1.6 + 0.36 * most))) as figure:
        for k, island in enumerate(islands):
            mine = [cell for cell in cells if cell.island == island]
            words = list(dict.fromkeys(cell.solver for cell in mine))
            axes = figure.add_subplot(len(islands), 1, k + 1)
            for cell in mine:
                x, y = values.index(cell.value), len(words) - 1 - words.index(cell.solver)
                axes.add_patch(Rectangle((x, y), 1, 1, facecolor=COLORS[cell.outcome], edgecolor="white"))
                if math.isfinite(cell.error) and cell.error > 0.0:
                    text = f"{round(math.log10(cell.error)):d}"
                    axes.text(x + 0.5, y + 0.5, text, ha="center", va="center", fontsize=7)
            for word in words:
                y = len(words) - 1 - words.index(word)
                row = {cell.value: cell.beyond for cell in mine if cell.solver == word}
                for x in range(1, len(values)):
                    if row.get(values[x - 1]) != row.get(values[x]):
                        axes.plot([x, x], [y, y + 1], color="black", lw=2.5, solid_capstyle="butt")
            axes.set(xlim=(0, len(values)), ylim=(0, len(words)), xlabel=label, title=f"{title}: {island}")
            axes.set_xticks([i + 0.5 for i in range(len(values))], [_tick(v) for v in values], rotation=60)
            axes.set_yticks([i + 0.5 for i in range(len(words))], words[::-1])
            axes.tick_params(length=0, labelsize=8)
        patches = [Patch(facecolor=color, label=name) for name, color in COLORS.items()]
        figure.legend(handles=patches, loc="outside lower center", ncols=4, frameon=False, fontsize="small")
