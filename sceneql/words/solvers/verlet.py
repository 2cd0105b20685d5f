"""verlet: the symplectic method of second order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field
from sceneql.stepping.splitting import VERLET
from sceneql.system import Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Verlet(Solver):
    """Velocity Verlet (leapfrog), order 2, one evaluation a step: half a kick, a drift, half a kick.

    v+ = v0 + h/2 a(x0), x1 = x0 + h v+, v1 = v+ + h/2 a(x1). Symplectic and reversible in time where forces depend on
    the positions alone: the error of the energy stays bounded for ever, and an undamped oscillation is stable up to
    h = 2/omega. Forces that depend on the velocity (drag, damping, magnetism) see v0 + h a: the order stays 2, but
    the method is no longer symplectic or reversible. States without a velocity advance by Heun's method with the slope
    handed on. Rigid bodies drift by their exact free rotation; on ties it is RATTLE (Andersen 1983), but for
    islands with parts that move by themselves, where ties are closed behind each step.
    Source: Verlet (1967), Phys. Rev. 159, 98-103; Swope, Andersen, Berens & Wilson (1982), J. Chem. Phys. 76, 637-649,
    eq. 5; Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), I.1.4.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps of the splitting."""
        return VERLET.fixed(self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of the step's matrix."""
        return VERLET.growth(jacobian, partner, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """That of the splitting."""
        return VERLET.oscillation(frequency, decay, step, turn)
