"""The choice of an implicit method's linear systems for a field: those of its grid, or of a general system."""

from __future__ import annotations

from dataclasses import replace
from math import prod
from typing import TYPE_CHECKING

from sceneql.kinds import Methods, Solver
from sceneql.system import Needs, Stepper

if TYPE_CHECKING:
    from sceneql.system import Grid, IslandFacts

KERNELS = "sceneql.grids.grid_stage_kernels"
MOST_CARRIED = {2: 300_000, 3: 30_000}
"""Cells of a flat or deep grid up to which general systems with a drift's entries are assembled."""
UNSOLVED = "Newton's method finds no solution of this step: take a shorter one"
UNSOLVED_AS_NAMED = f"{UNSOLVED}, or with a drift `linear: auto`"
BEYOND = "by Newton's method on all that its drift ties, from the first step on that this does not solve"


def grid_or_general(solver: Solver, linear: str, island: IslandFacts) -> Methods:
    """The methods that march an island by an implicit Runge-Kutta method; ``linear``: the solver of a grid's systems.

    Systems of grids contain diffusion and iterate on advection, which is fast but converges up to Courant numbers of
    about 1. Newton's method on all slopes, with the limiter's, has no such bound: it takes over where a fixed step does
    not converge, and makes all adaptive steps.
    """
    general, grid = solver.stepper(), island.fields.single
    if grid is None:
        return Methods(solver, general)
    many = prod(grid.cells.shape) > MOST_CARRIED[3 if grid.cells.shape[2] > 1 else 2]
    if not grid.carried or many or linear != "auto":
        return Methods(solver, _on_grid(general, linear, grid))
    if general.control.adaptive:
        return Methods(solver, general)
    on_grid = _on_grid(general, linear, grid)
    otherwise = replace(general, method=replace(general.method, dense=on_grid.method.dense))
    return Methods(solver, on_grid, otherwise=otherwise, remark=BEYOND)


def _on_grid(general: Stepper, linear: str, grid: Grid) -> Stepper:
    """The same method, its stages solved by the systems of the grid."""
    from sceneql.grids.prepare_stages import likely_kernels

    dense = None if general.control.adaptive else f"{KERNELS}:linear"
    return Stepper(
        replace(general.method, step=f"{KERNELS}:step", dense=dense),
        replace(general.control, unsolved=UNSOLVED if linear == "auto" else UNSOLVED_AS_NAMED, halves=False),
        Needs(prepare="sceneql.grids.prepare_stages:prepare", linear=linear, beside=likely_kernels(grid, linear)),
    )
