"""The stable step of a method on one oscillation, in plain Python: what `check` can know before the run."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

LEAST, MOST = 1e-8, 1e3
"""Range of (step times frequency) that is searched."""
RATIO = 1.3
"""Of the steps tried one after the other: a gap of stable steps narrower than that is not seen."""
NEUTRAL = 1e-8
"""Growth per unit of (step times frequency) that counts as none: rounding."""


@dataclass(frozen=True, slots=True)
class Oscillation:
    """A bound on the fastest x'' = -frequency^2 x - decay x' of a model."""

    frequency: float
    """Angular, undamped [1/s]."""
    decay: float
    """[1/s]; 0 where nothing damps it."""
    what: str
    """What sets it: ``spring 'tether'``."""
    at: tuple[str | int, ...] = ()
    """Where in the model's fields that stands: ``("springs", 2)``."""


def first_unstable(stable: Callable[[float], bool]) -> float:
    """End of the interval of stable steps from LEAST on, to 1e-6; 0 where it is empty, inf beyond MOST."""
    low = high = LEAST
    if not stable(low):
        return 0.0
    while stable(high):
        low, high = high, high * RATIO
        if low > MOST:
            return math.inf
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def stable_step(growth: Callable[[float], float]) -> float:
    """Largest stable step by the growth factor of a step; 0 where it is rounding alone that would allow one."""

    def bound(neutral: float) -> float:
        return first_unstable(lambda step: growth(step) <= 1.0 + 1e-14 + neutral * step)

    sharp, sharper = bound(NEUTRAL), bound(NEUTRAL / 100)
    return 0.0 if sharp < 100 * LEAST or sharper < 0.8 * sharp else sharp
