"""adams: multistep formulas of variable order."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field
from sceneql.system import Control, Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System

KERNELS = "sceneql.words.solvers.adams_kernels"
SETTLES = 16
"""Number of steps after which joints are closed, which costs as much as a step; in so few they open by no more than the
errors of the steps. Samples have them closed anyway."""


class Adams(Solver):
    """Adams' multistep formulas of orders 2 to 12: two evaluations of the rate a step, whatever the order.

    A polynomial through the rates of the latest steps predicts the end (Bashforth), and with the rate there corrects it
    (Moulton); then the rate is evaluated again (PECE). Steps of any length and order follow the error, which is held
    below ``absolute + tolerance |y|`` in the root mean square of all entries. For rates that are smooth and dear, at
    tolerances of 1e-6 and below: then it takes about half of dop853's evaluations. Every jump costs it its memory: at
    the start, and after impacts and other events, it begins with order 2 and short steps. Not for stiff systems.
    Source: Krogh (1974), Lect. Notes Math. 362, 22-71; Shampine & Gordon (1975), Computer Solution of Ordinary
    Differential Equations; Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), III.5 and III.7.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-9", at_least=1e-14, below=1)
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default the number of the relative.", None, above=0
    )
    order: int = field("The highest order that steps may have: stability falls with it.", 12, at_least=2, at_most=13)
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("Longest step allowed.", None, above=0)

    def explanation(self) -> str:
        """How orders come about."""
        return f"its order follows the errors, from 2 to {self.order}, and is 2 after every event"

    def explicit_by_tolerance(self) -> bool:
        """It is."""
        return True

    def stepper(self) -> Stepper:
        """Steps by the error, with the integral of the formula's polynomial as dense output."""
        return Stepper(
            Method(step=f"{KERNELS}:step", order=self.order, dense=f"{KERNELS}:dense", settles=SETTLES),
            Control(
                first_step=self.first_step or 0.0,
                adaptive=True,
                tolerance=self.tolerance,
                absolute=self.tolerance if self.absolute is None else self.absolute,
                largest_step=self.largest_step or inf,
                self_controlled=True,
            ),
            Needs(prepare=f"{__name__}:prepare"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """The least growth factor that one of its orders has on steps of one length: the one it comes to."""
        import numpy as np

        from sceneql.stepping.adams_growth import growth

        z: Any = step * np.linalg.eigvals(jacobian).astype(complex)
        return growth(z, self.order - 1)


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Tolerances, the highest order, and the room of the kernels."""
    from sceneql.words.solvers.adams_kernels import HEAD, LANES, VECTORS

    control = stepper.control
    return Prepared(
        (control.tolerance, control.absolute),
        (int(control.adaptive), stepper.method.order - 1),
        HEAD + VECTORS * LANES * -(-len(system.y) // LANES),
    )
