"""Which way an implicit method marches a field: by its grid, or as any other system."""

from __future__ import annotations

from dataclasses import replace
from math import prod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Grid, Stepper

MOST_CARRIED = {2: 300_000, 3: 30_000}
"""Cells of a flat or deep grid up to which systems with all that a drift ties are made."""

KERNELS = "sceneql.grids.grid_stage_kernels"
UNSOLVED = "Newton's method finds no solution of this step: take a shorter one"
UNSOLVED_AS_NAMED = f"{UNSOLVED}, or with a drift `linear: auto`"


def either_way(stepper: Stepper) -> Stepper:
    """An implicit Runge-Kutta method with what takes its place on an island that is one field on a grid."""
    on_grid = replace(
        stepper,
        step=f"{KERNELS}:step",
        dense=None if stepper.adaptive else f"{KERNELS}:linear",
        jacobian=False,
        newton=False,
        prepare="sceneql.grids.prepare_stages:prepare",
        unsolved=UNSOLVED if stepper.linear == "auto" else UNSOLVED_AS_NAMED,
        halves=False,
    )
    return replace(stepper, on_grid=on_grid)


def grid_or_general(stepper: Stepper, grid: Grid) -> Stepper:
    """What a stepper hands over for grids; where a drift acts, itself if need be.

    The systems of grids know the spread and go over what drifts again and again, which is quick but converges up to
    about a cell a step. Newton's method on all slopes, the limiter's among them, has no such bound: it takes over where
    a step of a given length is not solved, and makes those that a tolerance chooses.
    """
    if stepper.on_grid is None:
        return stepper
    many = prod(grid.cells.shape) > MOST_CARRIED[3 if grid.cells.shape[2] > 1 else 2]
    if not grid.carried or many or stepper.linear != "auto":
        return stepper.on_grid
    if stepper.adaptive:
        return stepper
    return replace(stepper.on_grid, otherwise=replace(stepper, dense=stepper.on_grid.dense))
