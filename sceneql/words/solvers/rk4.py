"""rk4: the classic Runge-Kutta method."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.tableau import CLASSIC

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Rk4(Solver):
    """The classic Runge-Kutta method, order 4, four evaluations of the rate a step.

    Stable on an undamped oscillation up to h = 2 sqrt(2)/omega, which it damps a little. Source: Kutta (1901),
    Z. Math. Phys. 46, 435-453.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        return CLASSIC.fixed(self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)|, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24."""
        return CLASSIC.growth(jacobian, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """That of the tableau."""
        return CLASSIC.oscillation(frequency, decay, step, turn)
