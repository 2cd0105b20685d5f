"""heun: the second-order method of Heun."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.tableau import Tableau
from sceneql.system import Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats

HEUN = Tableau(a=((), (1.0,)), b=(0.5, 0.5))


class Heun(Solver):
    """Heun's method, order 2: predict with Euler, then take the mean of the slopes at both ends.

    Like midpoint it is unstable on an undamped oscillation, slowly: a step multiplies it by
    sqrt(1 + (omega h)^4 / 4). Source: Heun (1900), Z. Math. Phys. 45, 23-38.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        return HEUN.fixed(self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)|, R(z) = 1 + z + z^2/2."""
        return HEUN.growth(jacobian, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """That of the tableau."""
        return HEUN.oscillation(frequency, decay, step, turn)
