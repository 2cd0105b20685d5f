"""Fixed steps that let a rough field ring: modes that decay fast keep their size and change sign at every step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.run.run import IslandRun

FAST = 2.0
"""Step times decay rate above which the trapezoidal rule changes signs."""
CARRIED = 0.5
"""Part of a mode that remains after a step, from which there is a warning."""


def ringing(island: IslandRun) -> Diagnostic | None:
    """A warning where the initial field has modes that the solver's fixed steps let ring.

    The decay rate of the roughest mode is estimated by the rate at the start over the spread of the field, with the
    bound of the cells (Gershgorin). Source: Rannacher (1984), Numer. Math. 43, 309-327.
    """
    march, grid = island.march, island.march.system.grid
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
    if step * decay <= FAST:
        return None
    left = island.solver.growth(np.array([[-decay]]), np.array([-1]), step)
    if not CARRIED <= left <= 1.0:
        return None
    name = island.island.models[0]
    word = type(island.solver).__module__.rpartition(".")[2]
    message = (
        f"'{name}' will ring: it has jumps that decay at {decay:.3g}/s, and a step of {step:.3g} s of {word} turns "
        f"their sign and keeps {100 * left:.0f}% of them"
    )
    help = f"march it by tr_bdf2, or take steps below {FAST / decay:.2g} s"
    return Diagnostic("ringing", message, island.graph.tasks[name].span, help, severity="warning")
