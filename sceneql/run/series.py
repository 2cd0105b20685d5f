"""Evaluation of expressions over a whole run, from the values of links at all its times."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Keys, Link, Symbol, children, rebuilt, walk
from sceneql.quantities.operations import OPERATIONS

Series = Mapping[Symbol | Link, Any]
"""Values (times, ...) of `time` and of each link."""


def plain(expr: Expr) -> bool:
    """Whether an expression has neither operations over the run nor reductions."""
    calls = (OPERATIONS[node.op] for node in walk(expr) if isinstance(node, Call))
    return not any(operation.series or operation.reduces for operation in calls)


def wanted(expr: Expr, when: Sequence[float], times: Sequence[float]) -> Iterator[tuple[Link, Sequence[float]]]:
    """The links of an expression, each with the times at which its value is needed.

    ``when``: those of the expression.
    """
    instants: dict[int, Sequence[float]] = {}
    stack, known = [(expr, when)], set[tuple[int, int]]()
    while stack:
        node, when = stack.pop()
        if (id(node), id(when)) in known:
            continue
        known.add((id(node), id(when)))
        if isinstance(node, Link):
            yield node, when
        if isinstance(node, Call) and OPERATIONS[node.op].series:
            when = instants.setdefault(id(node), _SERIES[node.op].instants(times, node))
        stack.extend((child, when) for child in reversed(children(node)))


def measure(expr: Expr, series: Series, times: list[float]) -> Any:
    """The value of an expression over series (times, ...); without an operation over the run, its value at the end.

    An `at` after the end of the run gives NaN.
    """
    if plain(expr):
        return evaluate(expr, lambda node: _look_up(node, series)[-1], arrays=True)
    return course(expr, series, times)


def course(expr: Expr, series: Series, times: list[float]) -> Any:
    """Values (times, ...) of an expression at each time; a single one where it has one for the whole run."""
    import numpy as np

    known: dict[Symbol, Any] = {}

    def look_up(node: Symbol | Link) -> Any:
        if isinstance(node, Symbol) and node in known:
            return known[node]
        return _look_up(node, series)

    def solved(old: Expr, node: Expr) -> Expr:
        if not isinstance(node, Call) or not OPERATIONS[node.op].series:
            return node
        value = np.asarray(evaluate(node.args[0], look_up, arrays=True))
        if value.ndim == len(node.args[0].type.shape):  # a constant: one value for the whole run
            value = np.broadcast_to(value, (len(times), *value.shape))
        symbol = Symbol(f"series {len(known)}", node.type)
        known[symbol] = _SERIES[node.op].of(value, times, node)
        return symbol

    return evaluate(rebuilt(expr, solved, _parts), look_up, arrays=True)


def _parts(node: Expr) -> tuple[Expr, ...]:
    """The children that may contain operations over the run; keyframes have none."""
    return () if isinstance(node, Keys) else children(node)


def _look_up(node: Symbol | Link, series: Series) -> Any:
    return series[Symbol("time")] if isinstance(node, Symbol) and node.name == "time" else series[node]


def instant_of(node: Call) -> float:
    """The instant [s] of an `at`."""
    return float(evaluate(node.args[1], {}))


def _at(value: Any, times: list[float], node: Call) -> Any:
    """The value at an instant, interpolated between times; NaN after the last."""
    instant = instant_of(node)
    if isinstance(value, float):  # one number of the whole run, as a `min` is
        return value if instant <= times[-1] else math.nan
    if instant > times[-1]:
        return value[-1] * math.nan
    after = bisect_left(times, instant)
    if times[after] == instant:
        return value[after]
    part = (instant - times[after - 1]) / (times[after] - times[after - 1])
    return value[after - 1] + part * (value[after] - value[after - 1])


def _drift(value: Any, times: list[float], node: Call) -> Any:
    """Change relative to the start, or, for a quantity that starts at 0, to its largest magnitude over the run."""
    import numpy as np

    scale = value[0] if np.all(value[0] != 0) else np.max(np.abs(value)) or 1.0
    return (value - value[0]) / scale


class _Series(NamedTuple):
    """The evaluation of an operation over the run."""

    of: Callable[[Any, list[float], Call], Any]
    """Function (series, its times, the call) to the value."""
    instants: Callable[[Sequence[float], Call], Sequence[float]] = lambda times, node: times
    """Function of all times and the call to the times at which the series is needed."""


_SERIES: Mapping[str, _Series] = {
    "final": _Series(lambda value, times, node: value[-1], lambda times, node: times[-1:]),
    "initial": _Series(lambda value, times, node: value[0], lambda times, node: times[:1]),
    "at": _Series(_at, lambda times, node: [instant_of(node)] if instant_of(node) <= times[-1] else times[-1:]),
    "relative_drift": _Series(_drift),
    "spread": _Series(lambda value, times, node: value.max(axis=0) - value.min(axis=0)),
}
