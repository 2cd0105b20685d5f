"""auto: the solver that suits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import FixedScalar, Solver, field
from sceneql.simulation.tableau import DORMAND_PRINCE
from sceneql.system import Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Auto(Solver):
    """The solver that suits: Dormand and Prince's adaptive method of order 5, at the tolerance asked for.

    Source: Dormand & Prince (1980); see the word dopri5.
    """

    reason: ClassVar[str] = "dopri5: its steps follow the tolerance, whatever the stiffness of the scene"

    tolerance: FixedScalar = field("Relative error of a step.", "1e-6", at_least=1e-14, below=1)

    def stepper(self) -> Stepper:
        """That of dopri5."""
        return DORMAND_PRINCE.adaptive(self.tolerance, self.tolerance)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """That of dopri5."""
        return DORMAND_PRINCE.growth(jacobian, step)
