"""bdf2: the backward differentiation formula of order 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field
from sceneql.system import Control, Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System

LEFT = 1e-2
"""Part of the error of the step before that Newton's method leaves in a step of a given length beside barriers. By
1e-10 a cube that is thrown onto a floor takes half as many updates again, and of the 8.5 mm by which its nodes are off
after ten steps 0.04 mm go (tests/test_barrier.py)."""


class Bdf2(Solver):
    """BDF2 on steps of any length, order 2: one implicit stage a step, by Newton's method on the Jacobian.

    A-stable and L-stable (on steps of one length): the cheapest way of order 2 through stiff scenes, if not the most
    exact. With ``step`` its steps are of one length, else they follow an error held below ``absolute + tolerance |y|``
    in the root mean square. It starts, and goes on after every event, with a step of implicit Euler. Source: Curtiss &
    Hirschfelder (1952), Proc. Natl. Acad. Sci. 38, 235-243; Hairer, Norsett & Wanner (1993), III.5.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-5", at_least=1e-14, below=1)
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default the number of the relative.", None, above=0
    )
    step: FixedTime | None = field("Length of a step, in place of a tolerance.", None, above=0)
    newton: FixedScalar | None = field(
        "Relative and absolute error that Newton's method leaves in a step of a given length, in SI units; by default "
        "1e-10 or, where barriers keep surfaces apart and that is more, a hundredth of the error of the step before.",
        None,
        above=0,
        below=1,
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer; by default as long as contacts allow.", None, above=0)

    def stepper(self) -> Stepper:
        """Fixed steps, or by the error."""
        from sceneql.stepping.implicit_tableau import NEWTON, NO_MEMORY, SHARE, UNSOLVED

        adaptive = self.step is None
        absolute = self.tolerance if self.absolute is None else self.absolute
        left = NEWTON if self.newton is None else self.newton
        newton = (self.tolerance, absolute, SHARE) if adaptive else (left, left, 1.0)
        part = LEFT if self.newton is None and not adaptive else 0.0
        return Stepper(
            Method(
                step="sceneql.words.solvers.bdf2_kernels:step",
                order=2,
                settings=(0.0, 1.0, *newton, *NO_MEMORY, float("-inf"), float("-inf"), 1.0, part, 0.0),
                numbers=(int(adaptive), 0),
                last_stage=1,
            ),
            Control(
                first_step=self.step or self.first_step or 0.0,
                adaptive=adaptive,
                tolerance=self.tolerance if adaptive else 0.0,
                absolute=absolute if adaptive else 0.0,
                largest_step=self.largest_step or float("inf"),
                self_controlled=adaptive,
                unsolved=UNSOLVED,
                halves=not adaptive,
            ),
            Needs(jacobian=True, newton=True, prepare="sceneql.words.solvers.bdf2:prepare"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |r| of the roots of (3/2 - h lambda) r^2 - 2 r + 1/2."""
        import numpy as np

        lead = 1.5 - step * np.linalg.eigvals(jacobian).astype(complex)
        root = np.sqrt(4.0 - 2.0 * lead)
        return float(np.abs(np.concatenate([2.0 + root, 2.0 - root]) / np.tile(2.0 * lead, 2)).max(initial=0.0))


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Arrays for bdf2_kernels.step on an island."""
    import numpy as np

    from sceneql.linear.stage import stage_plan
    from sceneql.words.solvers.bdf2_kernels import ARRAYS

    plan = stage_plan(system)
    assert system.pattern is not None
    room = system.pattern.room
    return Prepared(
        settings=np.concatenate([stepper.method.settings, plan.scales]),
        numbers=np.concatenate([stepper.method.numbers, [room], plan.numbers]),
        work=ARRAYS * len(system.y) + room + plan.store,
        text=plan.text,
        kept=ARRAYS * len(system.y),
    )
