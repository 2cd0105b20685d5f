"""The first step of an adaptive method."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats
    from sceneql.system import Stepper


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def first_step(
    stepper: Stepper, y: Floats, rate: Floats, alone: Any, end: float, rate_at: Callable[[float, Floats], Floats]
) -> float:
    """Length of the first step [s] (Hairer, Norsett & Wanner 1993, II.4, "starting step size").

    ``y``, ``rate`` (n,) at the start; ``alone`` (n,) bool: entries whose errors are scaled by their own magnitude;
    ``end`` of the run [s]. Such an entry counts where it is not zero; a zero, by its change in such a step.
    """
    if stepper.method.order == 0:  # it has no steps
        return end
    control = stepper.control
    scale = control.absolute + control.tolerance * np.abs(y)
    some_alone = alone.any()
    if some_alone:
        scale = np.where(alone, np.where(y == 0.0, np.inf, control.tolerance * np.abs(y)), scale)

    def norm(x: Floats) -> float:
        parts = x / scale
        return math.sqrt(float(np.add.reduce(parts * parts)) / len(x)) if len(x) else 0.0

    size, speed = norm(y), norm(rate)
    h = 1e-6 if size < 1e-5 or speed < 1e-5 else 0.01 * size / speed
    h = min(h, control.largest_step, end)
    if some_alone:
        change = control.tolerance * h * np.abs(rate)
        scale = np.where(alone & (scale == np.inf) & (change > 0.0), change, scale)
    bend = norm(rate_at(h, y + h * rate) - rate) / h
    most = max(speed, bend)
    guess = max(1e-6, 1e-3 * h) if not most > 1e-15 else (0.01 / most) ** (1.0 / stepper.method.order)
    return min(100.0 * h, guess, control.largest_step)
