"""exact: the exact solution of a field on a box, and of rigid bodies that move freely."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import Methods, Solver

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class Exact(Solver):
    """The solution itself, exact in time, of a field on the cells of a box, by the modes of its axes.

    `auto` takes it for rigid bodies, too, that nothing holds, touches or drives, under constant gravity or none: each
    turns by elliptic functions (van Zon & Schofield 2007, J. Comput. Phys. 225, 145) and flies along a parabola.

    The coefficient is constant, what holds on each side does not vary along it nor in time, and sources vary with the
    place alone. A picture costs a fast transform there and back. Source: Buzbee, Golub & Nielson (1970), SIAM J.
    Numer. Anal. 7, 627-656; Strang (1999), SIAM Review 41, 135-147.
    """

    marches = "a field"

    def stepper(self) -> Stepper:
        """None: a march of its own."""
        return _marched("sceneql.march.exact_march:ExactMarch")

    def choose(self, island: IslandFacts) -> Methods:
        """The march of a field, or of free bodies."""
        return Methods(self, _marched("sceneql.march.free_march:FreeMarch") if island.free else self.stepper())

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |exp(h lambda)|."""
        import numpy as np

        return float(np.abs(np.exp(step * np.linalg.eigvals(jacobian))).max(initial=0.0))


def _marched(march: str) -> Stepper:
    """No steps: a march of its own."""
    from sceneql.system import Control, Method, Needs, Stepper

    return Stepper(Method(step="", order=0), Control(adaptive=True), Needs(march=march))
