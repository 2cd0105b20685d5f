"""Breakpoints of expressions of time: keyframes, jumps, kinks and narrow pulses, which no step should cross.

Where the argument of an operation is linear in time, its breakpoints are solved for in closed form. Other arguments are
sampled over the run; each change is bracketed and refined. The breakpoints of subexpressions are found first, and the
whole is sampled at both sides of them, so that a pulse is seen however short it is. Smooth pulses (bells) and poles are
found too, at maxima of an exponential's argument and minima of a divisor.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sceneql.frame import Floats
from sceneql.island.breakpoint_table import APART, Breakpoint, after
from sceneql.kinds.values import TIME
from sceneql.quantities.curves import Table
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Keys, Link, Number, Symbol, children, each_once
from sceneql.quantities.key_tables import known_table
from sceneql.quantities.span import Span

MOST = 10_000
"""Largest number of breakpoints of an operation in a run; where there are more, none is kept."""
SAMPLES = (8192, 65536)
"""Numbers of intervals of the sampling grid; the finer grid is used where every second sample of the coarse one shows
fewer changes than all of them."""
FALLEN = (1.0, 4.0, 12.0, 30.0)
"""Drops of a pulse's logarithm below its maximum at which breakpoints are set, so that steps resolve its flanks."""
MOST_BELLS = 1000
"""Largest number of bells of a formula that become breakpoints: the error estimate sees an oscillation with more."""
NEAR = 1e-6
"""Distance of the places, as a share of the run, by which values and slopes at both sides of a breakpoint are told."""
LEAP, BEND = 1e-5, 1e-2
"""Least jumps of a formula and of its slope, as shares of the largest of the run, that count as such."""
PARTS = 32
"""Number of subintervals into which an interval with a change is divided, recursively."""

Cells = Callable[[Any], Any]
"""Maps an argument to a piece number (its floor or sign, say): the operation has a breakpoint where that changes."""
Even = tuple[float, float]
"""A function linear in time, as (value at 0, rate [1/s])."""


@dataclass
class Breakpoints:
    """Collects the breakpoints of expressions in a run from 0 to ``end`` [s].

    ``formula`` returns a linked output as an expression of time; None where it is solved for.
    """

    formula: Callable[[Link], Expr | None]
    end: float
    stops: set[Breakpoint] = field(default_factory=set)
    """Breakpoints within the run, and periodic ones."""
    beyond: list[Span | None] = field(default_factory=list)
    """Places in the script of operations with more breakpoints than MOST."""
    _followed: dict[int, Expr] = field(default_factory=dict)
    _formulas: dict[Link, Expr | None] = field(default_factory=dict)
    _even: dict[int, Even | None] = field(default_factory=dict)
    """By id of a node that depends on time alone, its linear function; None: it is not linear."""

    @np.errstate(all="ignore")
    def follow(self, expr: Expr, span: Span | None = None) -> None:
        """Add the breakpoints of an expression; ``span``: the place in the script of nodes without their own."""
        for node in each_once(expr, below=self._below) if id(expr) not in self._followed else ():
            if id(node) in self._followed:
                continue
            self._followed[id(node)] = node
            known = [id(child) in self._even for child in self._below(node)]
            other = isinstance(node, Symbol) and node.name not in TIME
            if other or not all(known) or (isinstance(node, Link) and not known):
                continue  # it reads the state
            self._even[id(node)] = self._evenly(node)
            found = [instant for number, cells in _turning(node) for instant in self._instants(number, cells)]
            found += [stop for number in _bells(node) for stop in self._bell(number)]
            if isinstance(node, Keys) and (table := known_table(node)) is not None:
                found += self._keys(node.argument, table)
            found = [stop for stop in found if stop[1] > 0.0 or APART * self.end < stop[0] < self.end]
            if len(found) + len(self.stops) > MOST:
                self.beyond.append(node.span or span)
            else:
                self.stops.update(found)

    @np.errstate(all="ignore")
    def leap(self, expr: Expr, bends: bool) -> float | None:
        """The first instant [s] in the run at which a formula of time jumps, or if it ``bends`` its slope; None: none.

        The start of the run where there are too many breakpoints to tell.
        """
        self.follow(expr)
        if self.beyond:
            return 0.0
        near, end = NEAR * self.end, self.end
        times = np.unique([time for stop in self.stops for time in _again(stop, end)])
        times = times[(times > 2.0 * near) & (times < end - 2.0 * near)]
        every = self._values(expr, np.linspace(0.0, end, SAMPLES[0] + 1))
        sides = [self._values(expr, times + k * near) for k in (-2, -1, 1, 2)]
        if every is None or any(side is None for side in sides):
            return None
        first, before, behind, last = np.array(sides)
        leaps = np.abs(2.0 * behind - last - 2.0 * before + first) > LEAP * np.abs(every).max()
        if bends:
            steepest = np.abs(np.diff(every)).max() * SAMPLES[0] * NEAR
            leaps |= np.abs(last - behind - before + first) > BEND * steepest
        return float(times[leaps][0]) if leaps.any() else None

    def _below(self, expr: Expr) -> tuple[Expr, ...]:
        if not isinstance(expr, Link):
            return children(expr)
        if expr not in self._formulas:
            self._formulas[expr] = self.formula(expr)
        meaning = self._formulas[expr]
        return () if meaning is None else (meaning,)

    def _evenly(self, node: Expr) -> Even | None:
        """Value at 0 and rate of a node that depends on time alone; None where it is not linear in time."""
        if id(node) in self._even:
            return self._even[id(node)]
        parts = [self._evenly(child) for child in self._below(node)]
        even = [part for part in parts if part is not None]
        if len(even) < len(parts) or node.type.shape:
            return None
        match node:
            case Number(value=value):
                return value, 0.0
            case Symbol():
                return 0.0, 1.0
            case Link():
                return even[0]
            case Call(op="add" | "sub" as op):
                (a, rise), (b, climb) = even
                return (a + b, rise + climb) if op == "add" else (a - b, rise - climb)
            case Call(op="neg"):
                return -even[0][0], -even[0][1]
            case Call(op="mul") if even[0][1] == 0.0 or even[1][1] == 0.0:
                (a, rise), (b, climb) = even
                return a * b, rise * b + climb * a
            case Call(op="div") if even[1][1] == 0.0 and even[1][0] != 0.0:
                return even[0][0] / even[1][0], even[0][1] / even[1][0]
            case Call() if all(rate == 0.0 for _, rate in even):
                found = self._values(node, np.zeros(1))
                return None if found is None else (float(found[0]), 0.0)
        return None

    def _values(self, expr: Expr, times: Floats) -> Floats | None:
        """Values (n,) of a scalar expression at instants (n,) [s]; None where it cannot be evaluated."""

        linked: dict[Link, Any] = {}

        def look_up(node: Symbol | Link) -> Any:
            if isinstance(node, Symbol):
                return times
            if node not in linked:
                linked[node] = evaluate(self._below(node)[0], look_up, arrays=True)
            return linked[node]

        try:
            found = np.asarray(evaluate(expr, look_up, arrays=True))
        except (KeyError, TypeError, ValueError):
            return None
        return np.broadcast_to(found, times.shape) if found.ndim == 0 else found if found.shape == times.shape else None

    def _keys(self, argument: Expr, table: Table) -> Iterator[Breakpoint]:
        even = self._evenly(argument)
        if even is None:
            yield from self._sampled(argument, _between(table))
        elif even[1] != 0.0 and math.isfinite(even[0] + even[1] * self.end):
            here, slope = even
            for time in table.times:  # a key belongs to the later piece; if the argument falls, the break is past it
                at = (time - here) / slope
                yield (at if slope > 0.0 else after(at, 2)), table.cycle / abs(slope)

    def _instants(self, number: Expr, cells: Cells) -> Iterator[Breakpoint]:
        """The breakpoints at which the piece number of an argument changes."""
        even = self._evenly(number)
        if even is None:
            yield from self._sampled(number, cells)
        elif even[1] != 0.0 and math.isfinite(even[0] + even[1] * self.end):
            here, slope = even
            first, last = 0, 0
            if cells is np.floor:
                low, high = sorted((here, here + slope * self.end))
                first = math.ceil(low)
                last = min(math.floor(high), first + MOST + 1)
            for whole in range(first, last + 1):
                yield after((whole - here) / slope, 2), 0.0

    def _sampled(self, number: Expr, cells: Cells) -> Iterator[Breakpoint]:
        """The breakpoints at changes of the piece number, by sampling on a grid refined at extrema of the argument."""
        grid = np.linspace(0.0, self.end, SAMPLES[0] + 1)
        where = self._cell(number, cells, grid)
        if where is None:
            return
        if np.count_nonzero(_changes(where)) != np.count_nonzero(_changes(where[::2])):
            grid = np.linspace(0.0, self.end, SAMPLES[1] + 1)
        known = np.array([time for stop in self.stops for time in _again(stop, self.end)])
        grid = np.unique(np.concatenate([grid, known, known - 4.0 * np.spacing(known)]))
        grid = np.union1d(grid, self._turned_round(number, cells, grid))
        changes = _changes(self._cell(number, cells, grid))
        low, high = grid[:-1][changes], grid[1:][changes]
        while 0 < len(low) <= MOST and np.any(high - low > np.spacing(np.maximum(low, APART * self.end))):
            pieces = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
            pieces[:, -1] = high
            changes = _changes(self._cell(number, cells, pieces.ravel()).reshape(pieces.shape))
            low, high = pieces[:, :-1][changes], pieces[:, 1:][changes]
        last = math.inf
        for time in high[: MOST + 1][::-1].tolist():  # backwards: of changes APART or closer only the last counts
            if last - time > APART * self.end:
                yield after(time, 2), 0.0
                last = time

    def _cell(self, number: Expr, cells: Cells, times: Floats) -> Any:
        """Piece numbers (n,) at instants (n,) [s]; None where the argument cannot be evaluated."""
        found = self._values(number, times)
        return None if found is None else np.nan_to_num(cells(found), nan=1e300)

    def _turned_round(self, number: Expr, cells: Cells, grid: Floats) -> Floats:
        """The instants of the argument's local extrema, where it may reach another piece between samples."""
        values = self._values(number, grid)
        assert values is not None
        rise = np.sign(np.diff(values))
        at = np.flatnonzero(rise[:-1] != rise[1:]) + 1
        way = np.where(rise[at] != 0.0, rise[at], -rise[at - 1])  # 1 at a minimum
        if cells is np.sign:
            at, way = at[way * values[at] > 0.0], way[way * values[at] > 0.0]
        if len(at) == 0 or len(at) > MOST:
            return grid[:0]
        return self._closed_in(number, grid[at - 1], grid[at + 1], way)

    def _bell(self, number: Expr) -> list[Breakpoint]:
        """Breakpoints of a pulse, given its logarithm: local maxima, and drops by FALLEN on both sides of these."""
        if self._evenly(number) is not None:
            return []
        grid = np.linspace(0.0, self.end, SAMPLES[0] + 1)
        values = self._values(number, grid)
        rise = np.sign(np.diff(np.zeros(2) if values is None else values))
        at = np.flatnonzero((rise[:-1] > 0.0) & (rise[1:] <= 0.0)) + 1
        if not 0 < len(at) <= MOST_BELLS:
            return []
        tops = self._closed_in(number, grid[at - 1], grid[at + 1], -1.0)
        stops = tops.tolist()
        valleys = np.concatenate([[0.0], 0.5 * (tops[1:] + tops[:-1]), [self.end]])

        def at_times(times: Floats) -> Floats:
            found = self._values(number, times)
            assert found is not None
            return found

        highest = at_times(tops)
        for fallen in FALLEN:
            for low, high in ((valleys[:-1].copy(), tops.copy()), (valleys[1:].copy(), tops.copy())):
                for _ in range(60):  # bisection, from the foot up
                    middle = 0.5 * (low + high)
                    below = at_times(middle) < highest - fallen
                    low, high = np.where(below, middle, low), np.where(below, high, middle)
                stops += high[np.abs(high - tops) > APART * self.end].tolist()
        return [(after(time, 2), 0.0) for time in stops]

    def _closed_in(self, number: Expr, low: Floats, high: Floats, way: Any) -> Floats:
        """The instants (k,) between low and high (k,) at which an expression is minimal (way 1) or maximal (way -1)."""
        way, rows = np.broadcast_to(way, low.shape), np.arange(len(low))
        for _ in range(9):  # to 2^-27 of a step: beyond, a smooth number is flat
            pieces = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, 17)
            found = self._values(number, pieces.ravel())
            assert found is not None
            best = np.argmin(way[:, None] * found.reshape(pieces.shape), axis=1)
            low, high = pieces[rows, np.maximum(best - 1, 0)], pieces[rows, np.minimum(best + 1, 16)]
        return (low + high) / 2.0


def _turning(node: Expr) -> list[tuple[Expr, Cells]]:
    """The arguments of an operation that switch between smooth pieces, each with its piece function.

    A `where` switches by its condition, which is an operation itself.
    """
    if not isinstance(node, Call) or any(arg.type.shape for arg in node.args):
        return []
    args = node.args
    match node.op:
        case "lt" | "le" | "gt" | "ge" | "eq" | "step":
            return [(Call("sub", args), np.sign)]
        case "min" | "max" as op:
            return [
                (Call("sub", (args[0] if k == 1 else Call(op, args[:k]), args[k])), np.sign)
                for k in range(1, len(args))
            ]
        case "abs" | "sign":
            return [(args[0], np.sign)]
        case "clamp":
            return [(Call("sub", (args[0], bound)), np.sign) for bound in args[1:]]
        case "ease":
            return [(args[0], np.sign), (Call("sub", (args[0], Number(1.0))), np.sign)]
        case "div":
            return [(args[1], np.sign)]
        case "tan":
            return [(Call("cos", args), np.sign)]
        case "log":
            return [(args[0], np.sign)]
        case "smoothstep":
            return [(Call("sub", (args[2], bound)), np.sign) for bound in args[:2]]
        case "floor" | "ceil" | "random":
            return [(arg, np.floor) for arg in args]
        case "round":
            return [(Call("add", (args[0], Number(0.5))), np.floor)]
        case "mod":
            return [(Call("div", args), np.floor)]
    return []


def _bells(node: Expr) -> list[Expr]:
    """Expressions for the logarithm of an operation's value, where that may be an arbitrarily narrow pulse."""
    if not isinstance(node, Call) or any(arg.type.shape for arg in node.args):
        return []
    match node:
        case Call(op="exp", args=(argument,)):
            return [argument]
        case Call(op="div", args=(_, divisor)) | Call(op="pow", args=(divisor, Number(value=-1.0 | -2.0))):
            return [Call("neg", (Call("log", (Call("abs", (divisor,)),)),))]
    return []


def _between(table: Table) -> Cells:
    """Piece function of a keyframe curve: the keys between which an argument lies, and the cycle."""
    times = np.array(table.times)

    def cells(number: Floats) -> Any:
        cycles: Any = 0.0
        if table.cycle > 0.0:
            cycles, rest = np.divmod(number - times[0], table.cycle)
            number = times[0] + rest
        return cycles * (len(times) + 1) + np.searchsorted(times, number, side="right")

    return cells


def _changes(cells: Any) -> Any:
    """(..., n - 1) bool: whether neighbors along the last axis of (..., n) differ."""
    return cells[..., 1:] != cells[..., :-1]


def _again(stop: Breakpoint, end: float) -> Iterator[float]:
    """The instants [s] of a breakpoint and its repetitions up to the end of the run."""
    time, period = stop
    if period <= 0.0:
        yield time
        return
    first = math.ceil(-time / period)
    for k in range(first, first + min(math.floor((end - time) / period) - first, MOST) + 1):
        yield time + k * period
