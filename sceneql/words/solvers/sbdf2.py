"""sbdf2: the backward differentiation formula of order 2, explicit in advection."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.flows.schemes import multistep
from sceneql.kinds import FixedTime, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Sbdf2(Solver):
    """Order 2 for flows: backward differentiation, viscosity implicit and advection extrapolated, then a projection.

    Rough modes die out at once, other than by `cnab2`. The pressure is kept from step to step and grows by what a
    projection takes away, in rotational form. Diffusion of fields that are solved with the flow is implicit too; all
    else is explicit. Source: Ascher, Ruuth & Wetton (1995), SIAM J. Numer. Anal. 32, 797-823; Guermond & Shen (2004),
    Math. Comp. 73, 1719-1737.
    """

    marches = "a flow"

    step: FixedTime = field("Length of a step.", "5 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps."""
        return multistep.stepper(multistep.SBDF2, 2, self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest of the modes', whose decay is implicit and whose turning explicit."""
        return multistep.largest_growth(
            jacobian, lambda decay, turn: multistep.growth(multistep.SBDF2, decay, turn, step)
        )

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """What decays is implicit, what turns explicit; none is told of swings."""
        return None if frequency > 0.0 else multistep.growth(multistep.SBDF2, decay, turn, step)
