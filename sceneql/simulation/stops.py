"""Instants at which values of a script change their course: steps that a tolerance chooses end there.

Such a step may be as long as nothing happens, and would go over a key, a pulse or a switch between two of its stages
without a sign of it in its error.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from sceneql.kinds.values import TIME
from sceneql.quantities.curves import known_table
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Keys, Link, Symbol, walk

Stop = tuple[float, float]
"""An instant at which what is new holds, and the period that it comes again with, 0 for none [s]."""

TURNING = ("lt", "le", "gt", "ge", "eq", "min", "max")
"""Operations on two numbers whose value turns where they are equal."""
APART = 1e-12
"""Instants nearer to each other than this part of the run count as one."""


def stops(expr: Expr, formula: Callable[[Link], Expr | None]) -> Iterator[Stop]:
    """Where an expression turns: at keys, and where what goes evenly with the time passes what it is compared with.

    ``formula`` gives a linked output as an expression of time; None for one that is solved.
    """
    for node in walk(expr):
        match node:
            case Link():
                meaning = formula(node)
                if meaning is not None:
                    yield from stops(meaning, formula)
            case Keys(argument=argument) if (table := known_table(node)) is not None:
                here, slope = _even(argument, formula)
                if slope > 0.0:
                    yield from (((time - here) / slope, table.cycle / slope) for time in table.times)
            case Call(op=op, args=args) if op in TURNING and len(args) == 2 and not any(one.type.shape for one in args):
                (first, rise), (second, climb) = (_even(one, formula) for one in args)
                if rise != climb and not math.isnan(rise - climb):
                    yield after((second - first) / (rise - climb), 2), 0.0


def after(time: float, steps: int = 4) -> float:
    """As little later as tells that rounding leaves it on the other side of an instant."""
    return time + steps * math.ulp(time)


def before(time: float) -> float:
    """As little earlier."""
    return time - 4 * math.ulp(time)


def _even(expr: Expr, formula: Callable[[Link], Expr | None]) -> tuple[float, float]:
    """What goes evenly with the time, as its value at 0 and its rate; (nan, nan) for all else."""

    def at(time: float) -> float:
        def look_up(node: Symbol | Link) -> float:
            if isinstance(node, Symbol) and node.name in TIME:
                return time
            meaning = formula(node) if isinstance(node, Link) else None
            if meaning is None:
                raise KeyError(node)
            return float(evaluate(meaning, look_up))

        return float(evaluate(expr, look_up))

    try:
        here, there, between = at(0.0), at(1e3), at(373.3)
    except (KeyError, TypeError, ValueError):  # it reads what is solved, or what is no number
        return math.nan, math.nan
    slope = (there - here) / 1e3
    even = abs(here + slope * 373.3 - between) <= 1e-12 * max(abs(here), abs(there))
    return (here, slope) if even else (math.nan, math.nan)


class Stops(NamedTuple):
    """Stops in the order in which they are looked up."""

    once: tuple[float, ...] = ()
    """Instants without a period, ascending [s]."""
    again: tuple[Stop, ...] = ()

    @classmethod
    def of(cls, found: Iterable[Stop]) -> Stops:
        """Those found, in any order."""
        known = sorted(stop for stop in found if not math.isnan(stop[0]))  # no order holds where one is no number
        return cls(tuple(at for at, period in known if period <= 0.0), tuple(stop for stop in known if stop[1] > 0.0))


def next_stop(known: Stops, time: float, end: float) -> float:
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
