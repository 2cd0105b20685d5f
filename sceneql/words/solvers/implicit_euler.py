"""implicit_euler: the implicit (backward) Euler method."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.grids.multigrid.linear_solvers import Linear
from sceneql.kinds import FixedScalar, FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class ImplicitEuler(Solver):
    """Implicit (backward) Euler, order 1: y1 = y0 + h f(t1, y1), by Newton's method on the Jacobian.

    A-stable and L-stable: no step grows a mode that does not grow by itself, and stiff ones die out at once. It damps
    what it should keep, too: a swing loses its energy with the step. Source: Curtiss & Hirschfelder (1952), Proc.
    Natl. Acad. Sci. 38, 235-243; Baraff & Witkin, Large steps in cloth simulation (1998).
    """

    step: FixedTime = field("Length of a step.", "10 ms", above=0)
    newton: FixedScalar = field(
        "Relative and absolute error that Newton's method leaves in a step of a given length, in SI units.",
        "1e-10",
        above=0,
        below=1,
    )

    linear: Linear = field("How the linear systems are solved where the island is a field on a grid.", "auto")

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        from sceneql.stepping.implicit_tableau import IMPLICIT_EULER

        return IMPLICIT_EULER.fixed(self.step, self.newton)

    def choose(self, island: IslandFacts) -> Methods:
        """By the systems of the grid where the island is a field on one."""
        from sceneql.grids.grid_or_general import grid_or_general

        return grid_or_general(self, self.linear, island)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |1 / (1 - h lambda)|."""
        from sceneql.stepping.implicit_tableau import IMPLICIT_EULER

        return IMPLICIT_EULER.growth(jacobian, step)
