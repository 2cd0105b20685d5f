"""Instants at which values of a script change their course (breakpoints.py): steps that a tolerance chooses end there.

Such a step may be as long as nothing happens, and would go over a key, a pulse or a switch between two of its stages
without a sign of it in its error.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable
from typing import NamedTuple

Breakpoint = tuple[float, float]
"""An instant at which what is new holds, and the period that it comes again with, 0 for none [s]."""

APART = 1e-12
"""Instants nearer to each other than this part of the run count as one."""


def after(time: float, steps: int = 4) -> float:
    """As little later as tells that rounding leaves it on the other side of an instant."""
    return time + steps * math.ulp(time)


def before(time: float) -> float:
    """As little earlier."""
    return time - 4 * math.ulp(time)


class BreakpointTable(NamedTuple):
    """BreakpointTable in the order in which they are looked up."""

    once: tuple[float, ...] = ()
    """Instants without a period, ascending [s]."""
    again: tuple[Breakpoint, ...] = ()

    @classmethod
    def of(cls, found: Iterable[Breakpoint]) -> BreakpointTable:
        """Those found, in any order."""
        known = sorted(stop for stop in found if not math.isnan(stop[0]))  # no order holds where one is no number
        return cls(tuple(at for at, period in known if period <= 0.0), tuple(stop for stop in known if stop[1] > 0.0))


def next_breakpoint(known: BreakpointTable, time: float, end: float) -> float:
    """The first of them after an instant, at most the end of the run [s]."""
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
