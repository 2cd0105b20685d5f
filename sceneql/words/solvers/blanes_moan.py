"""blanes_moan: a symplectic method of fourth order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.splitting import BLANES_MOAN
from sceneql.system import Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats


class BlanesMoan(Solver):
    """Blanes and Moan's symplectic method for x'' = a(x), order 4: seven kicks, six drifts, six evaluations a step.

    For the same cost its error is some hundred times smaller than that of Forest and Ruth (1990). Symplectic and
    reversible in time where forces depend on the positions alone; where they depend on the velocity, and for states
    without a velocity, its order is 2. Source: Blanes & Moan (2002), J. Comput. Appl. Math. 142, 313-330, table 3,
    SRKN6b.
    """

    refuses_ties: ClassVar[str] = "its drifts are free motions, and some of them go back in time"

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps of the splitting."""
        return BLANES_MOAN.fixed(self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of the step's matrix."""
        return BLANES_MOAN.growth(jacobian, partner, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """That of the splitting."""
        return BLANES_MOAN.oscillation(frequency, decay, step, turn)
