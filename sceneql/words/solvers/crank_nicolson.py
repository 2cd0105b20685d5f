"""crank_nicolson: the trapezoidal rule."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.grids.multigrid.linear_solvers import Linear
from sceneql.kinds import FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class CrankNicolson(Solver):
    """Crank-Nicolson, the trapezoidal rule, order 2: y1 = y0 + h/2 (f(t0, y0) + f(t1, y1)).

    A-stable: no step grows what decays. But not L-stable: what decays much faster than the step is carried on with its
    sign turned at every step, R(z) = (1 + z/2)/(1 - z/2) -> -1, so that a jump in the data of a diffusion rings where
    D step / cell^2 is large; tr_bdf2 or a few steps of implicit_euler at the start damp it. Source: Crank & Nicolson
    (1947), Proc. Camb. Phil. Soc. 43, 50-67; on the ringing Rannacher (1984), Numer. Math. 43, 309-327.
    """

    step: FixedTime = field("Length of a step.", "10 ms", above=0)
    linear: Linear = field("How the linear systems are solved where the island is a field on a grid.", "auto")

    def stepper(self) -> Stepper:
        """Fixed steps of the tableau."""
        from sceneql.stepping.implicit_tableau import CRANK_NICOLSON

        return CRANK_NICOLSON.fixed(self.step)

    def choose(self, island: IslandFacts) -> Methods:
        """By the systems of the grid where the island is a field on one."""
        from sceneql.grids.grid_or_general import grid_or_general

        return grid_or_general(self, self.linear, island)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |(1 + h lambda/2)/(1 - h lambda/2)|."""
        from sceneql.stepping.implicit_tableau import CRANK_NICOLSON

        return CRANK_NICOLSON.growth(jacobian, step)
