"""Warnings of fixed steps that let a rough field ring: fast modes keep their size and change sign at every step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.run.run import IslandRun
    from sceneql.system import Grid

FAST = 2.0
"""Step times decay rate above which the trapezoidal rule changes signs."""
CARRIED = 0.5
"""Fraction of a mode left after a step from which on there is a warning."""
SHOWN = 1e-4
"""Lag, relative to the field's spread or to the change at its boundary, from which on there is a warning."""


def ringing(island: IslandRun) -> Diagnostic | None:
    """A warning where the start has modes that ring with the solver's fixed steps: jumps, or cells at the boundary.

    For jumps, the decay rate of the roughest mode is estimated by the largest rate at the start over the spread of the
    field, bounded by the cells' conductances (Gershgorin). Source: Rannacher (1984), Numer. Math. 43, 309-327.
    """
    march, grid = island.march, island.march.system.fields.single
    control = march.stepper.control
    step = control.first_step
    if grid is None or control.adaptive or step <= 0.0:
        return None
    n = grid.cells.shape[0] * grid.cells.shape[1] * grid.cells.shape[2]
    field = march.system.y[grid.at : grid.at + n]
    rate = march.rate(0.0, march.system.y)[grid.at : grid.at + n]
    inside = field[~grid.cells.outside]
    change = float(np.abs(rate).max(initial=0.0))
    spread = float(np.ptp(inside)) or float(np.abs(inside).max(initial=0.0))
    faces = sum(march.floats[at : at + n] for at in grid.faces_at[: 3 if grid.cells.shape[2] > 1 else 2])
    allowed = 4.0 * float((faces / march.floats[grid.volumes_at : grid.volumes_at + n]).max())
    decay = min(change / spread, allowed) if spread > 0.0 else (allowed if change > 0.0 else 0.0)
    left, what = _left(island, step, decay), "it has jumps"
    if not CARRIED <= left <= 1.0:
        decay = _lag(island, grid, spread)
        left, what = (
            _left(island, step, decay),
            "values at its boundary vary, and cells there lag by differences",
        )
    if not CARRIED <= left <= 1.0:
        return None
    name = island.island.models[0]
    word = type(island.solver).__module__.rpartition(".")[2]
    message = (
        f"'{name}' will ring: {what} that decay at {decay:.3g}/s, and a step of {step:.3g} s of {word} turns "
        f"their sign and keeps {100 * left:.0f}% of them"
    )
    help = f"march it by tr_bdf2, or take steps below {FAST / decay:.2g} s"
    return Diagnostic("ringing", message, island.graph.tasks[name].span, help, severity="warning")


def _left(island: IslandRun, step: float, decay: float) -> float:
    """Fraction of a mode of decay rate ``decay`` [1/s] that a step [s] leaves with its sign changed.

    0: no change of sign.
    """
    if step * decay <= FAST:
        return 0.0
    return island.solver.growth(np.array([[-decay]]), np.array([-1]), step)


def _lag(island: IslandRun, grid: Grid, spread: float) -> float:
    """The exchange rate [1/s] of the cell that lags most behind its boundary value at the start; 0: no relevant lag.

    A cell that exchanges s/V (value - c) with a boundary value follows it with a lag of value' V/s. It starts without
    that lag, so a method without damping changes the sign of the difference at every step. s/V is measured by raising
    all cells by the same amount, which they lose by this exchange alone; s/V value' is the time derivative of the
    rates.
    """
    march = island.march
    n = int(np.prod(grid.cells.shape))
    mine = slice(grid.at, grid.at + n)
    y, step = march.system.y, march.stepper.control.first_step
    start = march.rate(0.0, y)[mine]
    raised = y.copy()
    raised[mine] += spread or 1.0
    exchange = (start - march.rate(0.0, raised)[mine]) / (spread or 1.0)
    change = np.abs(march.rate(step, y)[mine] - start) / step
    march.rate(0.0, y)
    carried = [z for z in FAST * 1.1 ** np.arange(80) if CARRIED <= _left(island, step, float(z) / step) <= 1.0]
    fast = ~grid.cells.outside & (step * exchange >= min(carried, default=np.inf))
    if not fast.any():
        return 0.0
    speeds = np.where(fast, change / np.where(fast, exchange, 1.0), 0.0)
    lags = np.where(fast, speeds / np.where(fast, exchange, 1.0), 0.0)
    worst = int(np.argmax(lags))
    if lags[worst] <= SHOWN * max(spread, float(speeds.max()) * march.end):
        return 0.0
    return float(exchange[worst])
