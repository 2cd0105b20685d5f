"""Measured runs of fields on grids: by cell size, and by the linear solver of a step."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import get_args

from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.report.grid_ends import REPEATS, End, difference, island_by
from sceneql.report.work_precision import settings


@dataclass(frozen=True, slots=True)
class GridRun:
    """A field on one grid at the end of the run."""

    island: str
    cell: float
    """Side of a cell [m]."""
    cells: int
    error: float
    """Root mean square error relative to the largest value, extrapolated from the next finer grid by the observed
    order."""
    seconds: float
    """Run time of the compiled steps, or of the exact solution [s]."""


@dataclass(frozen=True, slots=True)
class LinearRun:
    """One step of implicit_euler by a linear solver."""

    island: str
    linear: str
    step: float
    """[s]"""
    iterations: int
    seconds: float
    residuals: tuple[float, ...]
    """Residual at each check, relative to the first; empty for a direct solver."""


def on_grids(title: str, ends: Sequence[End]) -> tuple[list[GridRun], float | None]:
    """Errors on all grids but the finest, from coarse to fine, and the observed order in the cell size."""
    pairs = list(pairwise(ends))
    differences = [difference(coarse, fine) for fine, coarse in pairs]
    order = None
    if len(differences) > 1 and min(differences) > 0.0:
        order = math.log2(differences[-1] / differences[0]) / (len(differences) - 1)
    share = 1.0 - 2.0 ** -min(4.0, max(0.5, order or 2.0))
    rows = [
        GridRun(title, coarse.cell, coarse.cells, apart / share, coarse.seconds)
        for (_, coarse), apart in zip(pairs, differences, strict=True)
    ]
    return rows[::-1], order


def linear_runs(graph: SimulationGraph, island: Island) -> Iterator[LinearRun]:
    """One step of the script's length by every applicable linear solver, without those that do not converge."""
    from sceneql.grids.multigrid.linear_solvers import Linear
    from sceneql.grids.prepare_stages import report
    from sceneql.words.solvers.implicit_euler import ImplicitEuler

    step = min(settings(graph, island)[0], graph.settings.clock.end)
    for name in get_args(Linear):
        if name == "auto":
            continue
        times: list[float] = []
        try:
            while len(times) < REPEATS:
                march = island_by(graph, island, ImplicitEuler(step=step, linear=name)).march
                if march.system.fields.single is None:
                    return  # a system of several fields
                march.advance(step)
                times.append(march.statistics.seconds)
        except (LimitRefused, RunFailure):
            continue
        done = report(march.scratch)
        first = done.residuals[0] if done.residuals and done.residuals[0] > 0.0 else 1.0
        shares = tuple(size / first for size in done.residuals)
        yield LinearRun(", ".join(island.models), name, step, done.iterations, statistics.median(times), shares)
