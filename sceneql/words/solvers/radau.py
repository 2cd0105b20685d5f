"""radau: the implicit method Radau IIA of order 5, for stiff systems."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import field_validator

from sceneql.failure import LimitRefused, RunFailure
from sceneql.kinds import FixedScalar, FixedTime, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.system import Prepared, Stepper

KERNELS = "sceneql.stepping.radau_kernels"


class Radau(Solver):
    """Radau IIA of order 5: stiffly accurate and L-stable, so that stiffness never limits its steps.

    Three implicit stages a step, solved by Newton's iteration on the island's Jacobian, which serves as long as the
    iteration contracts well; its linear systems by full matrices where they are small, else by sparse factors of the
    real one, which iterations on the complex one share. The error of a step, in the root mean square of all entries,
    is held below ``tolerance`` times how large an entry has been: of late, for a state of equations, whatever its
    unit; for a position of a mass the largest that any of its model has had, at most 1 m unless its own is more, and
    for velocities likewise. An ``absolute`` that is given holds instead: the error is then below
    ``absolute + tolerance |y|``. Local contacts act between its steps, in which what rests stays tied; a step ends
    where a tie begins to pull.
    Sources: Hairer & Wanner, Solving Ordinary Differential Equations II (1996), IV.8; Cooper & Butcher (1983), IMA J.
    Numer. Anal. 3, 127-140.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-6", at_least=1e-14, below=1)
    absolute: FixedScalar | tuple[FixedScalar, ...] | None = field(
        "Absolute error of a step, in SI units, or one for each number of the state in turn; by default none: errors "
        "are relative to how large entries have been.",
        None,
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer; by default as long as contacts allow.", None, above=0)

    @field_validator("absolute")
    @classmethod
    def _is_positive(cls, absolute: float | tuple[float, ...] | None) -> float | tuple[float, ...] | None:
        if absolute is not None and not all(a > 0 for a in (absolute if isinstance(absolute, tuple) else (absolute,))):
            raise ValueError("an absolute tolerance must be greater than 0")
        return absolute

    def stepper(self) -> Stepper:
        """Steps by the error of the embedded method."""
        from sceneql.system import Control, Method, Needs, Stepper

        return Stepper(
            Method(step=f"{KERNELS}:step", order=5, dense=f"{KERNELS}:dense"),
            Control(
                first_step=self.first_step or 0.0,
                adaptive=True,
                tolerance=self.tolerance,
                absolute=self.tolerance if self.absolute is None else self.absolute,
                by_scale=self.absolute is None,
                largest_step=self.largest_step or float("inf"),
                self_controlled=True,
            ),
            Needs(jacobian=True, prepare=f"{__name__}:prepare", likely="sceneql.stepping.radau_systems:likely_kernels"),
        )

    def measure(self) -> str:
        """Scales of its own, where no absolute error is given."""
        return "of how large entries have been" if self.absolute is None else super().measure()

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)| with R(z) = (1 + 2z/5 + z^2/20) / (1 - 3z/5 + 3z^2/20 - z^3/60)."""
        import numpy as np

        z = step * np.linalg.eigvals(jacobian).astype(complex)
        return float(np.abs((1 + z * (0.4 + z / 20)) / (1 - z * (0.6 - z * (0.15 - z / 60)))).max(initial=0.0))


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Arrays for the step (radau_stages_kernels.py)."""
    import numpy as np

    from sceneql.stepping.error_scales import alone, error_scales
    from sceneql.stepping.radau_layout import MEMORY, VECTORS
    from sceneql.stepping.radau_systems import radau_systems
    from sceneql.system import Prepared

    n, pattern, control = len(system.y), system.pattern, stepper.control
    if pattern is None:
        message = f"radau needs the Jacobian of {n} entries: {system.unsloped} gives no slopes"
        raise LimitRefused(message, None, "take `auto`, `verlet` or `dop853`, which need none, or fewer masses")
    if isinstance(control.absolute, tuple) and len(control.absolute) != n:
        message = f"`absolute` has {len(control.absolute)} numbers, one for each of the state's {n} is needed"
        raise RunFailure(message, part="radau", time=0.0, span=None)
    rtol = control.tolerance if control.adaptive else 1e-12
    rounding = float(np.finfo(float).eps)
    newton = max(10 * rounding / rtol, min(3e-3, 0.1 * rtol**0.5))
    scaled, scales = np.zeros(0, np.int64), np.broadcast_to(control.absolute if control.adaptive else rtol, n)
    if control.adaptive and control.by_scale:
        scaled, scales = error_scales(system)
    systems = radau_systems(system)
    settings = np.concatenate([[rtol, newton, systems.contraction], scales, systems.rows])
    head = [not control.adaptive, pattern.room, len(pattern.tallies), len(scaled), len(settings) - len(systems.rows)]
    return Prepared(
        settings=settings,
        numbers=np.concatenate([head, systems.kernels, pattern.tallies, scaled, systems.plan]).astype(np.int64),
        work=MEMORY + VECTORS * n + pattern.room + systems.store,
        text=systems.text,
        alone=alone(scaled) if len(scaled) else None,
        scales=(3, len(scales)) if len(scaled) else (0, 0),
    )
