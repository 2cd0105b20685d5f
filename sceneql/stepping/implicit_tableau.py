"""Diagonally implicit Runge-Kutta methods as data: tableau, stability function, and preparation for an island."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING

from sceneql.system import Control, Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System

KERNELS = "sceneql.stepping.implicit_runge_kutta_kernels"
NEWTON = 1e-10
"""Relative and absolute tolerance of Newton's method where steps are fixed."""
UNSOLVED = "Newton's method finds no solution, not even of a thousandth of this step: take shorter ones"
NO_MEMORY = (0.0,) * 4
"""Initial memory of Newton's method, which follows its tolerances in the settings (newton_kernels)."""
SHARE = 0.02
"""Fraction of the tolerance that the error of Newton's method may use."""


@dataclass(frozen=True)
class ImplicitTableau:
    """Coefficients of a singly diagonally implicit method (SDIRK).

    Row i of ``a`` has the i entries below the diagonal and the diagonal's own. The first row may be empty: that stage
    is the rate at the start (Alexander 1977; Kennedy & Carpenter 2016).
    """

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    order: int
    b_hat: tuple[float, ...] | None = None
    """Weights of the embedded method whose difference is the error."""
    error_order: int = 0
    """The order in the step length of the error estimate."""
    dense: str | None = None

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.b)

    @property
    def diagonal(self) -> float:
        """The diagonal coefficient."""
        return self.a[-1][-1]

    @property
    def stiffly_accurate(self) -> bool:
        """Whether the last stage is the step's end (stiffly accurate)."""
        return self.a[-1] == self.b

    @cached_property
    def c(self) -> tuple[float, ...]:
        """Nodes of the stages, as fractions of the step: the row sums."""
        return tuple(sum(row) for row in self.a)

    def fixed(self, step: float, newton: float = NEWTON) -> Stepper:
        """Stepper of fixed length [s]; ``newton``: relative and absolute tolerance of Newton's method in a stage."""
        return self._stepper(first_step=step, newton=newton)

    def adaptive(
        self,
        tolerance: float,
        absolute: float,
        *,
        first_step: float = 0.0,
        largest_step: float = inf,
        by_scale: bool = False,
    ) -> Stepper:
        """Adaptive stepper by the error of the embedded method. Raises ValueError where there is none."""
        if self.b_hat is None:
            raise ValueError("a method without an embedded one has no error estimate")
        return self._stepper(tolerance, absolute, first_step=first_step, largest_step=largest_step, by_scale=by_scale)

    def growth(self, jacobian: Floats, step: float) -> float:
        """max |R(step * lambda)| over the eigenvalues of a (n, n) Jacobian, R(z) = 1 + z b (1 - z A)^-1 1."""
        import numpy as np

        z = step * np.linalg.eigvals(jacobian)
        matrix = np.zeros((self.stages, self.stages))
        for i, row in enumerate(self.a):
            matrix[i, : len(row)] = row
        ones = np.ones(self.stages)
        systems = np.eye(self.stages) - z[:, None, None] * matrix
        stages = np.linalg.solve(systems, np.broadcast_to(ones[:, None], (len(z), self.stages, 1)))
        return float(np.abs(1.0 + z * (stages[..., 0] @ np.array(self.b))).max(initial=0.0))

    def _stepper(
        self,
        tolerance: float = 0.0,
        absolute: float = 0.0,
        *,
        first_step: float,
        largest_step: float = inf,
        by_scale: bool = False,
        newton: float = NEWTON,
    ) -> Stepper:
        adaptive = tolerance > 0.0
        differences = [b - other for b, other in zip(self.b, self.b_hat or self.b, strict=True)]
        left = (tolerance, absolute, SHARE) if adaptive else (newton, newton, 1.0)
        lower = [entry for i, row in enumerate(self.a) for entry in row[:i]]
        return Stepper(
            Method(
                step=f"{KERNELS}:step",
                order=self.order,
                dense=self.dense,
                settings=(0.0, 1.0, *left, *NO_MEMORY, self.diagonal, *self.c, *self.b, *differences, *lower),
                numbers=(self.stages, int(not self.a[0]), int(self.stiffly_accurate), int(adaptive), self.error_order),
                last_stage=self.stages if self.stiffly_accurate else -1,
            ),
            Control(
                first_step=first_step,
                adaptive=adaptive,
                tolerance=tolerance,
                absolute=absolute,
                by_scale=by_scale,
                largest_step=largest_step,
                self_controlled=adaptive,
                unsolved=UNSOLVED,
                halves=not adaptive,
            ),
            Needs(jacobian=True, newton=True, prepare="sceneql.stepping.implicit_tableau:prepare"),
        )


def prepare(system: System, stepper: Stepper) -> Prepared:
    """The settings, integers and scratch of implicit_runge_kutta_kernels.step on an island."""
    import numpy as np

    from sceneql.linear.newton_kernels import ABSOLUTE
    from sceneql.linear.stage import stage_plan

    plan = stage_plan(system)
    assert system.pattern is not None
    method, stages = stepper.method, stepper.method.numbers[0]
    room = system.pattern.room
    settings, text = np.array(method.settings), plan.text
    if system.fields.single is not None:  # a field that drifts: grids/grid_or_general.py
        text += ", chosen since a drift may pass many cells in a step"
    if (system.fields.single is not None or system.fields.on_elements) and stepper.control.by_scale:
        settings[ABSOLUTE] *= float(np.abs(system.y).max(initial=0.0)) or 1.0
    return Prepared(
        settings=np.concatenate([settings, plan.scales]),
        numbers=np.concatenate([method.numbers, [len(method.settings), room], plan.numbers]),
        work=(5 + stages) * len(system.y) + room + plan.store,
        text=text,
        kept=(5 + stages) * len(system.y),
    )


_T = 2.0 - 2.0**0.5
_W = 2.0**0.5 / 4.0

IMPLICIT_EULER = ImplicitTableau(((1.0,),), (1.0,), order=1)
IMPLICIT_MIDPOINT = ImplicitTableau(((0.5,),), (1.0,), order=2, dense=f"{KERNELS}:linear")
CRANK_NICOLSON = ImplicitTableau(((), (0.5, 0.5)), (0.5, 0.5), order=2)
TR_BDF2 = ImplicitTableau(
    ((), (_T / 2, _T / 2), (_W, _W, _T / 2)),
    (_W, _W, _T / 2),
    order=2,
    b_hat=((1.0 - _W) / 3.0, (3.0 * _W + 1.0) / 3.0, _T / 6.0),
    error_order=3,
)
