"""tr_bdf2: the trapezoidal rule, then the backward differentiation formula of order 2, in one step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.grids.multigrid.linear_solvers import Linear
from sceneql.kinds import FixedScalar, FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class TrBdf2(Solver):
    """TR-BDF2, order 2: a trapezoidal step to t0 + (2 - sqrt 2) h, then a backward difference over both parts.

    A-stable and L-stable: stiff modes die out, and smooth motion is damped little. With ``step`` its steps are of one
    length, else they follow the error of the embedded third-order method, held below ``absolute + tolerance |y|`` in
    the root mean square. Source: Bank et al. (1985), IEEE Trans. Electron Devices 32, 1992-2007; Hosea & Shampine
    (1996), Appl. Numer. Math. 20, 21-37.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-5", at_least=1e-14, below=1)
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default the number of the relative (of a field, that part of "
        "its largest value at the start).",
        None,
        above=0,
    )
    step: FixedTime | None = field("Length of a step, in place of a tolerance.", None, above=0)
    newton: FixedScalar = field(
        "Relative and absolute error that Newton's method leaves in a step of a given length, in SI units.",
        "1e-10",
        above=0,
        below=1,
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer; by default as long as contacts allow.", None, above=0)

    linear: Linear = field("How the linear systems are solved where the island is a field on a grid.", "auto")

    def stepper(self) -> Stepper:
        """Fixed steps, or by the error of the embedded method."""
        from sceneql.stepping.implicit_tableau import TR_BDF2

        if self.step is not None:
            return TR_BDF2.fixed(self.step, self.newton)
        return TR_BDF2.adaptive(
            self.tolerance,
            self.tolerance if self.absolute is None else self.absolute,
            first_step=self.first_step or 0.0,
            largest_step=self.largest_step or float("inf"),
            by_scale=self.absolute is None,
        )

    def choose(self, island: IslandFacts) -> Methods:
        """By the systems of the grid where the island is a field on one."""
        from sceneql.grids.grid_or_general import grid_or_general

        return grid_or_general(self, self.linear, island)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)| with the stability function of the tableau."""
        from sceneql.stepping.implicit_tableau import TR_BDF2

        return TR_BDF2.growth(jacobian, step)
