"""The whole error of a field against run time: every scheme that applies, on several grids, by ever shorter steps."""

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
"""Grids that the finest one is ahead of a measured one: by its cells, a sixteenth of the error at second order."""
GRIDS = 3
STEPS = tuple(4**k for k in range(2, 10))
TOLERANCES = tuple(100.0**-k for k in range(1, 6))
SETTLED = 1.05
"""A shorter step is not tried where so many times the error of the grid itself is reached."""
ENOUGH_SECONDS = 0.2
"""No step is shorter than one that takes so long, and no run is repeated that has taken so long in all."""
LONGEST = 2.0
"""A run is given up after so many seconds of compiled steps."""


@dataclass(frozen=True, slots=True)
class SchemeRun:
    """A field at the end of the run by one scheme, on one grid, with one step or tolerance."""

    island: str
    solver: str
    cell: float
    """[m]"""
    setting: float
    """Step [s], or relative tolerance."""
    error: float
    """Root mean square, in parts of the largest value, of space and of time together."""
    seconds: float
    steps: int


def scheme_runs(
    graph: SimulationGraph, island: Island, schemes: Mapping[str, Solver], ends: Sequence[End]
) -> Iterator[SchemeRun]:
    """Runs by all schemes on grids that the finest of ``ends``, from fine to coarse, can judge; failed ones left out.

    On each, steps grow shorter until the error is that of the grid.
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
    """The runs that no other beats in both error and time, from quick to exact; without those that tell nothing."""
    best: list[SchemeRun] = []
    for run in sorted(runs, key=lambda run: (run.seconds, run.error)):
        if run.error < (best[-1].error if best else 1.0):
            best.append(run)
    return best


def told(runs: Sequence[SchemeRun]) -> list[str]:
    """For each grid's own error the scheme that reaches it first, as lines."""
    lines = []
    for better, worse in pairwise([*front(runs)[::-1], None]):
        if better is None or (worse is not None and worse.cell == better.cell):
            continue
        lines.append(
            f"    error {better.error:8.2e} first by {better.solver}, cell {better.cell:.4g} m,"
            f" {better.steps} steps: {better.seconds * 1e3:.3g} ms"
        )
    return lines[::-1]
