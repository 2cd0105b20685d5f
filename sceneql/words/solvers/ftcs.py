"""ftcs: forward in time, centered in space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.tableau import EULER

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Ftcs(Solver):
    """Forward in time, centered in space: the explicit Euler method on a grid, c1 = c0 + h (D laplace c0 + source).

    On cells of one side it is stable up to h = cell^2/(2 dims D), where a checkerboard turns its sign at every step
    without dying out; beyond it grows. `check` tells that limit of a constant coefficient, `explain` that of any.
    Source: O'Brien, Hyman & Kaplan (1950), J. Math. Phys. 29, 223-251 (von Neumann's analysis).
    """

    marches = "a field"

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
