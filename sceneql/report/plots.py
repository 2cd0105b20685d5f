"""Plots of a benchmark as SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sceneql.files import whole

if TYPE_CHECKING:
    from sceneql.report.work_precision import Measurement

MARKS = "osD^vP*X<>"


def error_against_time(
    path: Path, title: str, rows: Sequence[Measurement], orders: Mapping[tuple[str, str], float | None]
) -> None:
    """Write an SVG with a panel an island: relative error over run time [s], a line a solver, its order in the legend.

    ``orders`` by (island, solver); failed runs are counted in the legend.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    islands = list(dict.fromkeys(row.island for row in rows))
    # A fixed salt and no date: the same measurements make the same file.
    with rc_context({"svg.hashsalt": "sceneql", "svg.fonttype": "none"}):
        figure = Figure(figsize=(7.0, 4.8 * len(islands)), layout="constrained")
        for k, island in enumerate(islands):
            axes = figure.add_subplot(len(islands), 1, k + 1)
            axes.set(xscale="log", yscale="log", xlabel="run time [s]", ylabel="relative error at the end")
            axes.set_title(f"{title}: {island}")
            axes.grid(True, which="major", alpha=0.3)
            mine = [row for row in rows if row.island == island]
            for solver, mark in zip(dict.fromkeys(row.solver for row in mine), MARKS * len(mine), strict=False):
                runs = [row for row in mine if row.solver == solver]
                done = [row for row in runs if row.ok and row.error > 0.0]
                label = legend(solver, orders[island, solver], sum(not row.ok for row in runs))
                axes.plot([row.seconds for row in done], [row.error for row in done], marker=mark, ms=4, label=label)
            axes.legend()
        with whole(path) as file:
            figure.savefig(file, format="svg", metadata={"Date": None})


def legend(solver: str, order: float | None, failed: int) -> str:
    """``rk4, order 4.0, 2 failed``."""
    parts = [solver, "no order seen" if order is None else f"order {order:.1f}"]
    return ", ".join([*parts, f"{failed} failed"] if failed else parts)
