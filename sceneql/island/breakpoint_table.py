"""The table of breakpoints (found by breakpoints.py): instants at which values of a script are not smooth.

Adaptive steps end there: a long step would pass over a keyframe, a pulse or a switch between two of its stages without
a sign of it in its error estimate.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable
from typing import NamedTuple

Breakpoint = tuple[float, float]
"""(first instant of the new value, period of its repetition or 0 for none) [s]."""

APART = 1e-12
"""Breakpoints closer together than this fraction of the run count as one."""


def after(time: float, steps: int = 4) -> float:
    """The instant [s] ``steps`` ulps later, past the rounding error of ``time``."""
    return time + steps * math.ulp(time)


def before(time: float) -> float:
    """The instant [s] 4 ulps earlier."""
    return time - 4 * math.ulp(time)


class BreakpointTable(NamedTuple):
    """Breakpoints sorted for look-up."""

    once: tuple[float, ...] = ()
    """Instants without a period, ascending [s]."""
    again: tuple[Breakpoint, ...] = ()

    @classmethod
    def of(cls, found: Iterable[Breakpoint]) -> BreakpointTable:
        """The table of breakpoints in any order."""
        known = sorted(stop for stop in found if not math.isnan(stop[0]))  # a NaN has no place in the order
        return cls(tuple(at for at, period in known if period <= 0.0), tuple(stop for stop in known if stop[1] > 0.0))


def next_breakpoint(known: BreakpointTable, time: float, end: float) -> float:
    """The first breakpoint after an instant, at most the end of the run [s]."""
    best, least = end, time + APART * end
    first = bisect_right(known.once, least)
    if first < len(known.once) and known.once[first] < end - APART * end:
        best = known.once[first]
    for at, period in known.again:
        if at <= least:
            at += period * (math.floor((least - at) / period) + 1.0)
        if least < at < best - APART * end:
            best = at
    return best
