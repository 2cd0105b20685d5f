"""imex_midpoint: order 2 for flows of several fluids."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class ImexMidpoint(Solver):
    """Order 2 for flows of several fluids: skins and advection by the midpoint method, viscosity by TR-BDF2.

    What crosses a side of a cell takes its momentum along, so that a heavy fluid moves through a light one without
    noise, up to half a cell a step; the densities are those that skins cut off each cell. Steps follow the error, in
    parts of the largest velocity, and the waves of skins, unless ``step`` gives their length. The pressure grows by
    increments. Source: Peskin (2002), Acta Numerica 11, 479-517; Bank et al. (1985), IEEE Trans. Electron Devices 32,
    1992-2007; Nangia, Griffith, Patankar & Bhalla (2019), J. Comput. Phys. 390, 548-594.
    """

    marches = "several fluids"

    tolerance: FixedScalar = field("Error of a step, in parts of the largest value.", "1e-4", at_least=1e-12, below=1)
    step: FixedTime | None = field("Length of a step, in place of a tolerance.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer.", None, above=0)

    def stepper(self) -> Stepper:
        """By the tolerance, or fixed steps."""
        from sceneql.flows.varying import schemes

        return schemes.stepper(2, self.step, self.tolerance, self.largest_step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest of the modes', whose decay is implicit and whose turning explicit."""
        from sceneql.flows.schemes.multistep import largest_growth
        from sceneql.flows.varying import schemes

        return largest_growth(jacobian, lambda decay, turn: schemes.growth(2, decay, turn, step))

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """What decays is implicit, what turns explicit; none is told of swings."""
        from sceneql.flows.varying import schemes

        return None if frequency > 0.0 else schemes.growth(2, decay, turn, step)

    def measure(self) -> str:
        """In parts of the largest."""
        return "of the largest value of each field" if self.step is None else ""
