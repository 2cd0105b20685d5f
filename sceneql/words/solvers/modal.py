"""modal: linear motion of masses about their rest, by its lowest modes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import FixedScalar, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Modal(Solver):
    """Small motions about rest by their lowest modes, each exact in time: M x'' = F(t) - K x, K the stiffness at rest.

    Any law is taken as linear, so rotations must be small, too: `explain` tells the modes and how much of the start
    they hold. Rest is where the script places masses and solids, but for what is `bent`. Damping is as stiffness is
    (`retardation`), or as mass is; loads vary in time as they like; forces that no potential has, contacts and places
    that are led are refused. Source: Rayleigh, The Theory of Sound (1877); Ericsson & Ruhe (1980), Math. Comp. 35.
    """

    refuses_ties: ClassVar[str] = "its modes are those of masses that forces alone move"

    refuses_contacts: ClassVar[str] = "contacts are not linear, and modes do not go through them"

    modes: int = field("How many, the lowest first; six of a free body are its motions without strain.", 40, at_least=1)
    tolerance: FixedScalar = field(
        "By how much polynomials in time may differ from loads that vary, relative to the largest.",
        "1e-9",
        above=0,
        below=1,
    )

    def stepper(self) -> Stepper:
        """None: a march of its own."""
        from sceneql.system import Control, Method, Needs, Stepper

        return Stepper(
            Method(step="", order=0, numbers=(self.modes,)),
            Control(adaptive=True, tolerance=self.tolerance),
            Needs(jacobian=True, march="sceneql.march.modal_march:ModalMarch"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |exp(h lambda)|."""
        import numpy as np

        return float(np.abs(np.exp(step * np.linalg.eigvals(jacobian))).max(initial=0.0))
