"""Choice of the linear systems of an implicit method for a field: the grid's own solvers, or a general sparse one."""

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
"""Most cells of a 2D or 3D grid for which general systems with a drift's entries are assembled."""
UNSOLVED = "Newton's method finds no solution of this step: take a shorter one"
UNSOLVED_AS_NAMED = f"{UNSOLVED}, or with a drift `linear: auto`"
BEYOND = "by Newton's method on all that its drift ties, from the first step on that this does not solve"


def grid_or_general(solver: Solver, linear: str, island: IslandFacts) -> Methods:
    """The methods by which an implicit Runge-Kutta method marches an island; ``linear``: the grid's linear solver.

    The grid's solvers treat diffusion directly and iterate on advection: this is fast, but converges only up to Courant
    numbers of about 1. Newton's method with the full Jacobian, limiter included, has no such bound: it takes over where
    a fixed step does not converge, and makes all adaptive steps.
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
    """Stepper of the method ``general`` with stages solved by the grid's linear solvers."""
    from sceneql.grids.prepare_stages import likely_kernels

    dense = None if general.control.adaptive else f"{KERNELS}:linear"
    return Stepper(
        replace(general.method, step=f"{KERNELS}:step", dense=dense),
        replace(general.control, unsolved=UNSOLVED if linear == "auto" else UNSOLVED_AS_NAMED, halves=False),
        Needs(prepare="sceneql.grids.prepare_stages:prepare", linear=linear, beside=likely_kernels(grid, linear)),
    )
