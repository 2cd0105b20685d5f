"""How fast a march comes on: told while it runs, and whether it can end at all."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from sceneql.doing import duration

if TYPE_CHECKING:
    from sceneql.doing import Deed

A_CALL = 0.3
"""Seconds that a call of so many steps is to take."""
MOST_STEPS = 1e11
"""Most steps of a run, or of the rest of a way to the next instant: those of a single mass take half an hour."""
LOOKS, FEWEST = 3, 10_000
"""Looks in a row, and steps meanwhile, that must find so many: the first steps of a stiff start are as short."""
YEARS, FEWER = 1e8, 2_000
"""Where steps take long: seconds that all would take, from which on fewer of them are enough."""
GROWING = 1.5
"""Factor from look to look by which steps grow that are on their way to be longer."""


class Pace:
    """The pace of a march on its way to an instant ``target`` [s], from a time [s] after so many steps."""

    def __init__(self, deed: Deed, target: float, t: float, steps: int) -> None:
        self._deed, self._target = deed, target
        self._last = t, steps, time.perf_counter()
        self._mean = 0.0
        self._looks, self._since, self._endless = 0, steps, True

    @property
    def until_look(self) -> int | None:
        """Steps to the next look, where it is soon to be known whether the march leads anywhere; else None."""
        return FEWEST if self._endless else None

    def at_once(self, t: float, steps: int, took: float) -> int:
        """How many steps the next call may take, after one that came to a time [s] in so many steps and seconds.

        While the pace is not known, tell of that time.
        """
        if self._mean == 0.0:
            self._deed.what = f"solving, at {t:.6g} s"
        return max(1, int(steps * min(2.0, A_CALL / max(took, 1e-9))))

    def hopeless(self, t: float, steps: int) -> bool:
        """Tell of the pace at a time [s] after so many steps; whether it leads nowhere."""
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
