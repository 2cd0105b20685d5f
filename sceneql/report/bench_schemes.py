"""The total error of a field against run time: every applicable scheme, on several grids, with decreasing steps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Solver
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.grid_ends import End, difference, end_on
from sceneql.report.work_precision import adaptive, at

COARSER = 2
"""Number of halvings from a measured grid's cell to the finest grid's: a sixteenth of the error at second order."""
GRIDS = 3
STEPS = tuple(4**k for k in range(2, 10))
TOLERANCES = tuple(100.0**-k for k in range(1, 6))
SETTLED = 1.05
"""No shorter step is tried once the error is this multiple of the grid's own error."""
ENOUGH_SECONDS = 0.2
"""Run time [s] after which no shorter step is tried, and time of all repeats of a run."""
LONGEST = 2.0
"""Time of compiled steps [s] after which a run is given up."""


@dataclass(frozen=True, slots=True)
class SchemeRun:
    """A run of a field by one scheme, on one grid, with one step or tolerance, at the end."""

    island: str
    solver: str
    cell: float
    """[m]"""
    setting: float
    """Step [s], or relative tolerance."""
    error: float
    """Root mean square error of space and time together, relative to the largest value."""
    seconds: float
    steps: int


def scheme_runs(
    graph: SimulationGraph, island: Island, schemes: Mapping[str, Solver], ends: Sequence[End]
) -> Iterator[SchemeRun]:
    """Runs by all schemes on grids much coarser than the finest of ``ends``, from fine to coarse; without failed ones.

    On each grid, steps decrease until the error is that of the grid.
    """
    title = ", ".join(island.models)
    for end in ends[COARSER : COARSER + GRIDS]:
        least = SETTLED * difference(end, ends[0])
        for word, solver in schemes.items():
            span = graph.settings.clock.end
            for setting in TOLERANCES if adaptive(solver) else [span / count for count in STEPS]:
                try:
                    found = end_on(graph, island, at(solver, setting), end.cell, LONGEST, ENOUGH_SECONDS)
                except (ScriptError, LimitRefused):
                    break
                except RunFailure:
                    continue
                error = difference(found, ends[0])
                if math.isfinite(error):
                    yield SchemeRun(title, word, end.cell, setting, error, found.seconds, found.steps)
                if error <= least or found.seconds > ENOUGH_SECONDS:
                    break


def front(runs: Sequence[SchemeRun]) -> list[SchemeRun]:
    """The Pareto front in error and time, from fast to accurate, of runs with errors below the field itself."""
    best: list[SchemeRun] = []
    for run in sorted(runs, key=lambda run: (run.seconds, run.error)):
        if run.error < (best[-1].error if best else 1.0):
            best.append(run)
    return best


def told(runs: Sequence[SchemeRun]) -> list[str]:
    """Lines that name, for each grid, the scheme that reaches the grid's own error first."""
    lines = []
    for better, worse in pairwise([*front(runs)[::-1], None]):
        if better is None or (worse is not None and worse.cell == better.cell):
            continue
        lines.append(
            f"    error {better.error:8.2e} first by {better.solver}, cell {better.cell:.4g} m,"
            f" {better.steps} steps: {better.seconds * 1e3:.3g} ms"
        )
    return lines[::-1]
