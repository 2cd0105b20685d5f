"""dop853: the adaptive method of order 8 of Dormand and Prince."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field
from sceneql.system import Control, Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System

KERNELS = "sceneql.words.solvers.dop853_kernels"


class Dop853(Solver):
    """Dormand and Prince's method of order 8, its error estimated by orders 5 and 3; dense output of order 7.

    The best explicit method for tight tolerances, say 1e-7 and below. Twelve evaluations a step, and three more for a
    step that a frame is read from. The error of a step is held below ``absolute + tolerance |y|`` in the root mean
    square of all entries. Source: Dormand & Prince (1989); Hairer, Norsett & Wanner, Solving Ordinary Differential
    Equations I (1993), II.5, II.6 and II.10 (code DOP853).
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-9", at_least=1e-14, below=1)
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default the number of the relative.", None, above=0
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("Longest step allowed.", None, above=0)

    def explicit_by_tolerance(self) -> bool:
        """It is."""
        return True

    def stepper(self) -> Stepper:
        """Steps by the error, with the method's own dense output."""
        return Stepper(
            Method(
                step=f"{KERNELS}:step", order=8, dense=f"{KERNELS}:dense", last_stage=12, extend=f"{KERNELS}:extend"
            ),
            Control(
                first_step=self.first_step or 0.0,
                adaptive=True,
                tolerance=self.tolerance,
                absolute=self.tolerance if self.absolute is None else self.absolute,
                largest_step=self.largest_step or inf,
            ),
            Needs(prepare=f"{__name__}:prepare"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)| with the stability function of the tableau."""
        from sceneql.stepping.dormand_prince_8 import DORMAND_PRINCE_8

        return DORMAND_PRINCE_8.growth(jacobian, step)


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Coefficients in the layout of the kernels; with exact contacts every step computes its dense output."""
    import numpy as np

    from sceneql.stepping.dormand_prince_8 import BEND, DORMAND_PRINCE_8, EXTRA, FIFTH, THIRD
    from sceneql.stepping.error_scales import alone, error_scales

    rows = (*DORMAND_PRINCE_8.a, DORMAND_PRINCE_8.b, *EXTRA)
    places = (*DORMAND_PRINCE_8.c, 1.0, *(sum(row) for row in EXTRA))
    bends = (weight for row in BEND for weight in row)
    acts = system.structure
    # Where nothing but the removal of errors acts behind steps, the march evaluates the rate at their ends after it.
    late = bool(acts.settling) and not (acts.after or acts.local or system.pairs)
    plan, scales = error_scales(system) if stepper.control.by_scale else (np.zeros(0, np.int64), np.zeros(0))
    settings = (
        stepper.control.tolerance,
        stepper.control.absolute,
        *(weight for row in rows for weight in row),
        *places,
        *FIFTH,
        *THIRD,
        *bends,
        *scales,
        np.nan,
    )
    return Prepared(
        settings,
        (int(stepper.control.adaptive), int(system.pairs > 0), int(late), len(plan), *plan),
        (21 + 3 * stepper.control.by_scale) * len(system.y),
        alone=alone(plan) if len(plan) else None,
        scales=(len(settings) - len(scales) - 1, len(scales)),
        last_stage=-1 if late else None,
    )
