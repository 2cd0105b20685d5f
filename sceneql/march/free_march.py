"""The march of rigid bodies that nothing but uniform forces move: their exact motion at any instant."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from sceneql.march.march import March

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class FreeMarch(March):
    """Turns each body by its exact rotation without torque and moves it along a parabola, without steps."""

    def _engage(self, stepper: Stepper) -> None:
        """Find the velocities and the accelerations, which are constant."""
        positions = np.flatnonzero(self.system.partner >= 0)
        self._positions, self._velocities = positions, self.system.partner[positions]
        self._accelerations = self.rate(0.0, self._y1)[self._velocities]
        course = "along parabolas" if self._accelerations.any() else "at constant speed"
        self.prepared_text = f"the exact motion of each body at any instant, turning without torque {course}"

    def _reach(self, t: float) -> tuple[Floats, bool]:
        """The state at an instant: x + t v + t^2 a/2, v + t a, and the exact rotation."""
        if not self._started:
            self._start()
            self.statistics.steps = 1  # one step reaches any instant
        started = time.perf_counter()
        y = self._y1.copy()
        if t > 0.0:
            y[self._positions] += t * (y[self._velocities] + 0.5 * t * self._accelerations)
            y[self._velocities] += t * self._accelerations
            self.driver.free_motion(t, y, self.floats, self.system.ints)
        self.statistics.seconds += time.perf_counter() - started
        return self._settled(t, y), False
