"""cnab2: Adams-Bashforth for advection, Crank-Nicolson for viscosity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.flows.schemes import multistep
from sceneql.kinds import FixedTime, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Cnab2(Solver):
    """Adams and Bashforth's method of order 2 for advection, Crank and Nicolson's for viscosity, then a projection.

    Order 2; the pressure is kept from step to step and grows by what a projection takes away. Diffusion of fields that
    are solved with the flow is implicit too; all else is explicit. It rings where viscosity is large for the step, and
    advection without viscosity grows slowly. Source: Kim & Moin (1985), J. Comput. Phys. 59, 308-323; Brown, Cortez &
    Minion (2001), J. Comput. Phys. 168, 464-499.
    """

    marches = "a flow"

    step: FixedTime = field("Length of a step.", "5 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps."""
        return multistep.stepper(multistep.CNAB2, 2, self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest of the modes', whose decay is implicit and whose turning explicit."""
        return multistep.largest_growth(
            jacobian, lambda decay, turn: multistep.growth(multistep.CNAB2, decay, turn, step)
        )

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """What decays is implicit, what turns explicit; none is told of swings."""
        return None if frequency > 0.0 else multistep.growth(multistep.CNAB2, decay, turn, step)
