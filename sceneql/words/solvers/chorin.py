"""chorin: the projection method of order 1."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.flows.schemes import multistep
from sceneql.kinds import FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class Chorin(Solver):
    """Explicit Euler for advection, implicit Euler for viscosity, then a projection; order 1: the baseline of flows.

    Diffusion of fields that are solved with the flow is implicit too; all else is explicit. Source: Chorin (1968),
    Math. Comp. 22, 745-762; Temam (1969), Arch. Rational Mech. Anal. 33, 377-385.
    """

    marches = "a flow"

    step: FixedTime = field("Length of a step.", "5 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps."""
        return multistep.stepper(multistep.CHORIN, 1, self.step)

    def choose(self, island: IslandFacts) -> Methods:
        """The same with masses that move, where density or viscosity varies."""
        if island.fields.flow is None or not island.fields.flow.varying:
            return super().choose(island)
        from sceneql.flows.varying import schemes

        return Methods(self, schemes.stepper(1, self.step))

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest of the modes', whose decay is implicit and whose turning explicit."""
        return multistep.largest_growth(
            jacobian, lambda decay, turn: multistep.growth(multistep.CHORIN, decay, turn, step)
        )

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """What decays is implicit, what turns explicit; none is told of swings."""
        return None if frequency > 0.0 else multistep.growth(multistep.CHORIN, decay, turn, step)
