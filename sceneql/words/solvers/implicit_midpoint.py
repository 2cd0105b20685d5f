"""implicit_midpoint: the implicit midpoint rule."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.grids.multigrid.linear_solvers import Linear
from sceneql.kinds import FixedScalar, FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class ImplicitMidpoint(Solver):
    """The implicit midpoint rule, order 2: y1 = y0 + h f(t0 + h/2, (y0 + y1)/2), by Newton's method on the Jacobian.

    A-stable, symmetric and symplectic: it damps nothing, and conserves quadratic invariants (angular momentum, the
    energy of linear springs) to rounding. What it does not resolve rings on with the wrong period; between the ends of
    its steps the state is taken as a line. Source: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006),
    II.1.3 and IV.2.1.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)
    newton: FixedScalar = field(
        "Relative and absolute error that Newton's method leaves in a step of a given length, in SI units.",
        "1e-10",
        above=0,
        below=1,
    )

    linear: Linear = field("How the linear systems are solved where the island is a field on a grid.", "auto")

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        from sceneql.stepping.implicit_tableau import IMPLICIT_MIDPOINT

        return IMPLICIT_MIDPOINT.fixed(self.step, self.newton)

    def choose(self, island: IslandFacts) -> Methods:
        """By the systems of the grid where the island is a field on one."""
        from sceneql.grids.grid_or_general import grid_or_general

        return grid_or_general(self, self.linear, island)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |(1 + h lambda / 2) / (1 - h lambda / 2)|."""
        from sceneql.stepping.implicit_tableau import IMPLICIT_MIDPOINT

        return IMPLICIT_MIDPOINT.growth(jacobian, step)
