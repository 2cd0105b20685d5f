"""Measuring what `expect` says of a scene: numbers of its run, against exact, independent or conserved values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from sceneql import pipeline
from sceneql.graph import SimulationGraph
from sceneql.kinds import Expect
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Link, Symbol, Vector, children, walk
from sceneql.quantities.operations import OPERATIONS


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an expectation measured."""

    name: str
    expect: Expect
    measured: float
    wanted: float
    error: float
    """|measured - wanted|, or measured for one that must stay below."""
    limit: float
    """What the error may be at most."""

    @property
    def holds(self) -> bool:
        """Whether it is as expected (NaN is not)."""
        return self.error <= self.limit

    def __str__(self) -> str:
        verdict = "ok" if self.holds else "DIFFERS"
        what = f"below {self.limit:.3g}" if self.expect.value is None else f"{self.wanted:.12g} +- {self.limit:.2g}"
        off = "" if self.expect.value is None else f" (off by {self.error:.2g})"
        return f"{verdict}: {self.name} = {self.measured:.12g}{off}, expected {what}: {self.expect.because}"


def outcomes(graph: SimulationGraph, variant: str | None = None) -> list[Outcome]:
    """Measure every expectation of a graph that holds for the variant, in one run."""
    wanted = {name: e for name, e in graph.settings.expect.items() if e.variant == variant}
    if not wanted:
        return []
    clock = graph.settings.clock
    instants = {*clock.frames(clock.fps), clock.end}
    values = [value for e in wanted.values() for value in (e.of, e.value, e.below) if value is not None]
    nodes = [node for value in values for node in walk(value.expr)]
    instants |= {_instant(node) for node in nodes if isinstance(node, Call) and node.op == "at"}
    times = sorted(t for t in instants if t <= clock.end)
    wants: dict[Link, set[float]] = {}
    for value in values:
        for link, when in _wanted(value.expr, times[-1:] if _plain(value.expr) else times, times):
            wants.setdefault(link, set()).update(when)
    series = _sample(graph, times, wants)
    return [_outcome(name, expect, series, times) for name, expect in wanted.items()]


def _plain(expr: Expr) -> bool:
    """Whether nothing in an expression asks for more than one time: it is then read at the end."""
    calls = (OPERATIONS[node.op] for node in walk(expr) if isinstance(node, Call))
    return not any(operation.series or operation.reduces for operation in calls)


def _wanted(expr: Expr, when: Sequence[float], times: Sequence[float]) -> Iterator[tuple[Link, Sequence[float]]]:
    """The links of an expression that counts at some of the times, with those at which each counts."""
    if isinstance(expr, Link):
        yield expr, when
    if isinstance(expr, Call) and OPERATIONS[expr.op].series:
        when = _SERIES[expr.op].instants(times, expr)
    for child in children(expr):
        yield from _wanted(child, when, times)


def _sample(graph: SimulationGraph, times: list[float], wants: Mapping[Link, set[float]]) -> dict[Symbol | Link, Any]:
    """Links at the times, each (times, ...): NaN when it is not wanted, for reading may cost a mesh."""
    import numpy as np

    rows: dict[Link, list[Any]] = {link: [] for link in wants}
    for time, moment in zip(times, pipeline.simulate(graph, times), strict=True):
        for link, row in rows.items():
            row.append(moment.read(link.task, link.output) if time in wants[link] else None)
    return {Symbol("time"): np.array(times), **{link: _filled(row) for link, row in rows.items()}}


def _filled(row: list[Any]) -> Any:
    """(times, ...) of values, NaN where there are none."""
    import numpy as np

    known = [np.asarray(value) for value in row if value is not None]
    if len(known) == len(row):
        return np.array(row)
    blank = np.full(known[0].shape, np.nan)
    return np.array([blank if value is None else value for value in row])


def _outcome(name: str, expect: Expect, series: Mapping[Symbol | Link, Any], times: list[float]) -> Outcome:
    import numpy as np

    measured = float(np.max(measure(expect.of.expr, series, times)))
    if expect.value is not None:
        wanted = float(np.max(measure(expect.value.expr, series, times)))
        return Outcome(name, expect, measured, wanted, abs(measured - wanted), expect.tolerance)
    assert expect.below is not None
    limit = float(np.max(measure(expect.below.expr, series, times)))
    return Outcome(name, expect, measured, limit, measured, limit)


def measure(expr: Expr, series: Mapping[Symbol | Link, Any], times: list[float]) -> Any:
    """The value of an expression over series (times, ...); one without an operation on time is read at the end.

    What is asked for after the end of the run is NaN.
    """
    known: dict[Symbol, Any] = {}

    def look_up(node: Symbol | Link) -> Any:
        if isinstance(node, Symbol) and node in known:
            return known[node]
        return series[Symbol("time")] if isinstance(node, Symbol) else series[node]

    def solve(node: Expr) -> Expr:
        if isinstance(node, Vector):
            return replace(node, items=tuple(solve(item) for item in node.items))
        if not isinstance(node, Call):
            return node
        args = tuple(solve(arg) for arg in node.args)
        node = Call(node.op, args, node.type, node.span)
        if not OPERATIONS[node.op].series:
            return node
        value = evaluate(args[0], look_up, arrays=True)
        symbol = Symbol(f"series {len(known)}", node.type)
        known[symbol] = _SERIES[node.op].of(value, times, node)
        return symbol

    if _plain(expr):
        return evaluate(expr, lambda node: look_up(node)[-1], arrays=True)
    return evaluate(solve(expr), look_up, arrays=True)


def _instant(node: Call) -> float:
    return float(evaluate(node.args[1], {}))


def _at(value: Any, times: list[float], node: Call) -> Any:
    instant = _instant(node)
    return value[times.index(instant)] if instant <= times[-1] else value[-1] * math.nan


def _drift(value: Any, times: list[float], node: Call) -> Any:
    """Relative to the start, or, for a quantity that starts at 0, to its largest magnitude over the run."""
    import numpy as np

    scale = value[0] if np.all(value[0] != 0) else np.max(np.abs(value)) or 1.0
    return (value - value[0]) / scale


class _Series(NamedTuple):
    """What an operation on time makes of a series."""

    of: Callable[[Any, list[float], Call], Any]
    """(series, its times, the call) to its value."""
    instants: Callable[[Sequence[float], Call], Sequence[float]] = lambda times, node: times
    """The times that count."""


_SERIES: Mapping[str, _Series] = {
    "final": _Series(lambda value, times, node: value[-1], lambda times, node: times[-1:]),
    "initial": _Series(lambda value, times, node: value[0], lambda times, node: times[:1]),
    "at": _Series(_at, lambda times, node: [_instant(node)] if _instant(node) <= times[-1] else times[-1:]),
    "relative_drift": _Series(_drift),
    "spread": _Series(lambda value, times, node: value.max(axis=0) - value.min(axis=0)),
}
