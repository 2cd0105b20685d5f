"""midpoint: the explicit midpoint rule."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.tableau import MIDPOINT

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Midpoint(Solver):
    """The explicit midpoint rule, order 2: y1 = y0 + h f(t0 + h/2, y0 + h/2 f(t0, y0)).

    On an undamped oscillation it grows too, by about (omega h)^4 / 8 a step: slowly, but for every step.
    Source: Runge (1895), Math. Ann. 46, 167-178.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        return MIDPOINT.fixed(self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)|, R(z) = 1 + z + z^2/2."""
        return MIDPOINT.growth(jacobian, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """That of the tableau."""
        return MIDPOINT.oscillation(frequency, decay, step, turn)
