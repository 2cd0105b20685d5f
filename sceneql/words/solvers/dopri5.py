"""dopri5: the adaptive method of Dormand and Prince."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field
from sceneql.stepping.tableau import DORMAND_PRINCE

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Dopri5(Solver):
    """Dormand and Prince's pair of orders 5 and 4: steps follow the error, with dense output of order 4.

    The error of a step is held below ``absolute + tolerance |y|`` in the root mean square of all entries.
    Source: Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19-26; step control and dense output as in
    Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.4-II.6.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-6", at_least=1e-14, below=1)
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default the number of the relative.", None, above=0
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer; by default as long as contacts allow.", None, above=0)

    def explicit_by_tolerance(self) -> bool:
        """It is."""
        return True

    def stepper(self) -> Stepper:
        """Steps by the error of the embedded method."""
        return DORMAND_PRINCE.adaptive(
            self.tolerance,
            self.tolerance if self.absolute is None else self.absolute,
            first_step=self.first_step or 0.0,
            largest_step=self.largest_step or float("inf"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)| with the stability function of the fifth-order method."""
        return DORMAND_PRINCE.growth(jacobian, step)
