"""Energy drift of an island in time under each solver."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.failure import RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Solver
from sceneql.report.work_precision import LONGEST, prepared, setting_of

if TYPE_CHECKING:
    from sceneql.run.invariants import Invariant
    from sceneql.run.watch import Balance

MOMENTS = 200


@dataclass(frozen=True, slots=True)
class Drift:
    """Change of energy in one run, relative to the largest kinetic or initial energy.

    Without energy, of an invariant.
    """

    island: str
    solver: str
    setting: float
    """Step [s], or relative tolerance."""
    times: tuple[float, ...]
    changes: tuple[float, ...]
    """(E(t) - E(0)) / scale."""
    momentum: float = math.nan
    """Largest change of momentum, relative to the sum of the masses' momenta; NaN where momentum is not conserved."""
    driven: bool = False
    """Whether energy changes in truth, as by values that vary in time."""


def drift(graph: SimulationGraph, island: Island, word: str, solver: Solver) -> Drift | None:
    """The drift up to the end or a failure of the run; None where no model has an energy or an invariant."""
    from sceneql.run.run import Run
    from sceneql.run.watch import Watch

    run = Run(prepared(graph, island, solver))
    watch = Watch(run, always=True)
    conserved: list[Balance | Invariant] = [*watch.balances, *watch.invariants]
    if not conserved:
        return None
    end = graph.settings.clock.end
    try:
        for moment in run.moments(end * k / MOMENTS for k in range(MOMENTS + 1)):
            watch.look(moment)
            if run.islands[0].march.statistics.seconds > LONGEST:
                break
    except RunFailure:
        pass
    first = conserved[0]
    balance = watch.balances[0] if watch.balances else None
    told = balance is not None and balance.isolated and balance.impulse > 0.0
    return Drift(
        ", ".join(island.models),
        word,
        setting_of(solver),
        tuple(first.times),
        tuple(first.drifts),
        balance.momentum / balance.impulse if balance is not None and told else math.nan,
        balance is not None and not balance.closed,
    )
