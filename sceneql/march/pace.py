"""Progress of a march: reports while it runs, and the judgment whether it can finish at all."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from sceneql.doing import duration

if TYPE_CHECKING:
    from sceneql.doing import Deed

A_CALL = 0.3
"""Intended duration of a compiled call [s]."""
MOST_STEPS = 1e11
"""Largest number of steps of a run, or of the rest up to the next instant: those of a single mass take half an hour."""
LOOKS, FEWEST = 3, 10_000
"""Number of consecutive checks, and of steps meanwhile, that must predict too many steps: the first steps of a stiff
start are as short."""
YEARS, FEWER = 1e8, 2_000
"""Predicted duration [s] from which on FEWER steps suffice, where steps take long."""
GROWING = 1.5
"""Factor from check to check by which steps grow that will soon be longer."""


class Pace:
    """The pace of a march towards an instant ``target`` [s]; ``t`` [s] and ``steps``: where it is now."""

    def __init__(self, deed: Deed, target: float, t: float, steps: int) -> None:
        self._deed, self._target = deed, target
        self._last = t, steps, time.perf_counter()
        self._mean = 0.0
        self._looks, self._since, self._endless = 0, steps, True

    @property
    def until_look(self) -> int | None:
        """Number of steps to the next check, where it is soon to be known whether the march ends; else None."""
        return FEWEST if self._endless else None

    def at_once(self, t: float, steps: int, took: float) -> int:
        """Number of steps of the next call, after a call that came to time t [s] in that many steps and seconds.

        While the pace is not known, the progress text gives that time.
        """
        if self._mean == 0.0:
            self._deed.what = f"solving, at {t:.6g} s"
        return max(1, int(steps * min(2.0, A_CALL / max(took, 1e-9))))

    def hopeless(self, t: float, steps: int) -> bool:
        """Update the progress text at time t [s] and step count; returns whether the march is hopeless."""
        t0, before, at = self._last
        if steps == before:
            return False
        now, grown = time.perf_counter(), t - t0 > GROWING * self._mean * (steps - before)
        self._last, self._mean = (t, steps, now), (t - t0) / (steps - before)
        left = (self._target - t) / self._mean if self._mean > 0.0 else float("inf")
        seconds = left * (now - at) / (steps - before)
        self._deed.what = f"solving, at {t:.6g} s: steps of {self._mean:.2g} s, to the next instant {duration(seconds)}"
        self._endless = not left < MOST_STEPS
        if grown or not self._endless:
            self._looks, self._since = 0, steps
        else:
            self._looks += 1
        return self._looks >= LOOKS and steps - self._since >= (FEWER if seconds > YEARS else FEWEST)
