"""exact: the exact solution of a field on a box."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import Solver

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Exact(Solver):
    """The solution itself, exact in time, of a field on the cells of a box, by the modes of its axes.

    The coefficient is constant, what holds on each side does not vary along it nor in time, and sources vary with the
    place alone. A picture costs a fast transform there and back. Source: Buzbee, Golub & Nielson (1970), SIAM J.
    Numer. Anal. 7, 627-656; Strang (1999), SIAM Review 41, 135-147.
    """

    marches = "a field"

    def stepper(self) -> Stepper:
        """None: a march of its own."""
        from sceneql.system import Control, Method, Needs, Stepper

        return Stepper(
            Method(step="", order=0), Control(adaptive=True), Needs(march="sceneql.march.exact_march:ExactMarch")
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |exp(h lambda)|."""
        import numpy as np

        return float(np.abs(np.exp(step * np.linalg.eigvals(jacobian))).max(initial=0.0))
