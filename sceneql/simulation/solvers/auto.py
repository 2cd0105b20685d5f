"""auto: the solver that suits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, Solver, field
from sceneql.simulation.tableau import DORMAND_PRINCE

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Auto(Solver):
    """The solver that suits: Dormand and Prince's adaptive method of order 5, at the tolerance asked for.

    Source: Dormand & Prince (1980); see the word dopri5.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-6", at_least=1e-14, below=1)

    def choice(self) -> str:
        """Its one choice so far."""
        return "it takes dopri5, whose steps follow the tolerance in stiff scenes too"

    def stepper(self) -> Stepper:
        """That of dopri5."""
        return DORMAND_PRINCE.adaptive(self.tolerance, self.tolerance)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """That of dopri5."""
        return DORMAND_PRINCE.growth(jacobian, step)
