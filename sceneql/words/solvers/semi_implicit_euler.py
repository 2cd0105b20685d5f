"""semi_implicit_euler: velocities first, then positions by the new velocities."""

from __future__ import annotations

from cmath import sqrt
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedTime, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class SemiImplicitEuler(Solver):
    """Semi-implicit (symplectic) Euler, order 1: v1 = v0 + h a(t0, x0, v0), x1 = x0 + h v1.

    The loop that most people write first, and better than it looks: on an undamped oscillation it is stable up to
    h = 2/omega and its energy stays bounded. States without a velocity advance by explicit Euler.
    Source: de Vogelaere (1956); Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), I.1.2.
    """

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps; the rate at the step's start is all that it needs."""
        from sceneql.system import Control, Method, Stepper

        return Stepper(
            Method(step="sceneql.words.solvers.semi_implicit_euler_kernels:step", order=1),
            Control(first_step=self.step),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of the step's own matrix: explicit Euler's, with h^2 times the velocities' rows added."""
        import numpy as np

        change = step * np.asarray(jacobian)
        positions = np.flatnonzero(np.asarray(partner) >= 0)
        matrix = np.eye(len(change)) + change
        matrix[positions] += step * change[np.asarray(partner)[positions]]
        return float(np.abs(np.linalg.eigvals(matrix)).max(initial=0.0))

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """Larger root of g^2 - (2 - d - (step frequency)^2) g + 1 - d, d = step (decay - i turn); 1 - g to rounding."""
        square = (step * frequency) ** 2
        half = 0.5 * (step * complex(decay, -turn) + square)
        root = sqrt(half * half - square)
        return max(abs(1.0 - (half - root)), abs(1.0 - (half + root)))
