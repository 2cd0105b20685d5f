"""Symplectic splitting methods as data: kicks of the velocities by the forces, and drifts of the positions between."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Any

from sceneql.kinds.eigenvalues import eigenvalues
from sceneql.system import Control, Method, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats


@dataclass(frozen=True)
class Splitting:
    """Coefficients of a splitting: alternating kicks and drifts, the exact flows of v' = a(x) and of x' = v.

    A step begins and ends with a kick. Each flow is symplectic where the forces have a potential, and so is the step
    (Yoshida 1990; McLachlan & Quispel 2002). A force that depends on the velocity is evaluated at a velocity
    extrapolated by half a kick with the previous acceleration; entries of y without velocities change with the kicks.
    With either, the order is 2 and the step not symplectic.
    """

    kicks: tuple[float, ...]
    """Kicks as fractions of the step, one more than the drifts."""
    drifts: tuple[float, ...]
    order: int
    """The order for forces that depend on positions alone."""

    def fixed(self, step: float) -> Stepper:
        """Stepper of fixed length [s].

        The rate at a step's end serves the next step, so a drift costs one evaluation.
        """
        return Stepper(
            Method(
                step="sceneql.stepping.splitting_kernels:step",
                order=self.order,
                settings=(*self.kicks, *self.drifts),
                numbers=(len(self.drifts),),
                work=3,
                last_stage=0,
            ),
            Control(first_step=step),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of the step's linear map of (state, rate passed on), a (2n, 2n) matrix."""
        import numpy as np

        j, of = np.asarray(jacobian, dtype=float), np.asarray(partner)
        n = len(j)
        positions = np.flatnonzero(of >= 0)
        pushed = (of < 0)[:, None]
        y, rate = np.eye(n, 2 * n), np.eye(n, 2 * n, n)
        y = y + self.kicks[0] * step * pushed * rate
        for drift, kick, ahead in zip(self.drifts, self.kicks[1:], self.leads(), strict=True):
            y[positions] += drift * step * y[of[positions]]
            rate = j @ (y + ahead * step * pushed * rate)
            y = y + kick * step * pushed * rate
        return float(np.abs(np.linalg.eigvals(np.vstack([y, rate]))).max(initial=0.0))

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """Growth factor of a step on one mode, in plain Python.

        The map of an undamped oscillation has determinant 1: its trace tells the growth.
        """
        if decay or turn:
            return self._damped(frequency, -complex(decay, -turn), step)
        columns = []
        for x, v in ((1.0, 0.0), (0.0, 1.0)):
            v -= self.kicks[0] * step * frequency**2 * x
            for drift, kick in zip(self.drifts, self.kicks[1:], strict=True):
                x += drift * step * v
                v -= kick * step * frequency**2 * x
            columns.append((x, v))
        half = 0.5 * abs(columns[0][0] + columns[1][1])
        return half + sqrt(half * half - 1.0) if half > 1.0 else 1.0

    def _damped(self, frequency: float, damping: complex, step: float) -> float:
        """As `growth`, for position, velocity and rate of a mode: eigenvalues of the step's change over its length."""
        columns = []
        for x0, v0, rate in ((1.0, 0.0, 0j), (0.0, 1.0, 0j), (0.0, 0.0, 1 + 0j)):
            moved, pushed, last = 0j, self.kicks[0] * rate, rate
            for drift, kick, ahead in zip(self.drifts, self.kicks[1:], self.leads(), strict=True):
                moved += drift * (v0 + step * pushed)
                seen = v0 + step * (pushed + ahead * rate)
                rate = damping * seen - frequency**2 * (x0 + step * moved)
                pushed += kick * rate
            columns.append((moved, pushed, (rate - last) / step))
        changes = eigenvalues(list(zip(*columns, strict=True)))
        return max(abs(1.0 + step * change) for change in changes)

    def leads(self) -> tuple[float, ...]:
        """Fractions of the step by which each evaluation extrapolates the velocity: to the middle of its kick."""
        return (*(0.5 * kick for kick in self.kicks[1:-1]), self.kicks[-1])


VERLET = Splitting((0.5, 0.5), (1.0,), 2)

_A, _B = (0.245298957184271, 0.604872665711080), (0.0829844064174052, 0.396309801498368, -0.0390563049223486)
_A3, _B4 = 0.5 - sum(_A), 1.0 - 2.0 * sum(_B)
BLANES_MOAN = Splitting((*_B, _B4, *reversed(_B)), (*_A, _A3, _A3, *reversed(_A)), 4)
