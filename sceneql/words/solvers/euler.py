"""euler: the explicit Euler method."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.tableau import EULER

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Euler(Solver):
    """Explicit Euler, order 1: y1 = y0 + h f(t0, y0).

    The first method of every course. On an undamped oscillation of frequency omega it grows by
    sqrt(1 + (omega h)^2) a step, so no step is stable; where there is damping, a small enough one is.
    Source: Euler, Institutiones calculi integralis (1768), I, section 650.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        return EULER.fixed(self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |1 + h lambda|."""
        return EULER.growth(jacobian, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """That of the tableau."""
        return EULER.oscillation(frequency, decay, step, turn)
