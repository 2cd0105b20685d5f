"""adi: alternating directions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Adi(Solver):
    """Alternating directions for a field on a grid, order 2: implicit along x, then y, then z, each a row at a time.

    y1 = y0 + (1 - h/2 Az)^-1 (1 - h/2 Ay)^-1 (1 - h/2 Ax)^-1 h f(t + h/2, y0): Crank-Nicolson but for a term of h^3,
    for the cost of a few explicit steps, and stable at any step. It rings as that does. A coefficient that depends on
    the field is taken from the start of a step, which is of order 1. Source: Peaceman & Rachford (1955), J. Soc.
    Indust. Appl. Math. 3, 28-41; Douglas & Gunn (1964), Numer. Math. 6, 428-453.
    """

    marches = "a field"

    step: FixedTime = field("Length of a step.", "10 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps."""
        from sceneql.system import Control, Method, Needs, Stepper

        return Stepper(
            Method(
                step="sceneql.grids.multigrid.adi_kernels:step",
                order=2,
                dense="sceneql.grids.grid_stage_kernels:linear",
            ),
            Control(first_step=self.step),
            Needs(prepare="sceneql.grids.adi:prepare"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |(1 + h lambda/2)/(1 - h lambda/2)|: of what varies along one axis alone; else it is less."""
        from sceneql.stepping.implicit_tableau import CRANK_NICOLSON

        return CRANK_NICOLSON.growth(jacobian, step)
