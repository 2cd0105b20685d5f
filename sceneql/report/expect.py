"""Measurement of the numbers in a scene's `expect`, against exact, independent or conserved values."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from sceneql import pipeline
from sceneql.graph import SimulationGraph
from sceneql.kinds import Expect, Moment, Value
from sceneql.quantities.expression import Call, Link, Symbol, walk
from sceneql.run.series import Series, instant_of, measure, plain, wanted


@dataclass(frozen=True, slots=True)
class Outcome:
    """The measurement of one expectation."""

    name: str
    expect: Expect
    measured: float
    wanted: float
    error: float
    """|measured - wanted|; the measured value itself where that must stay below a bound."""
    limit: float
    """Largest error allowed."""

    @property
    def holds(self) -> bool:
        """Whether the measurement is as expected (NaN is not)."""
        return self.error <= self.limit

    def __str__(self) -> str:
        verdict = "ok" if self.holds else "DIFFERS"
        what = f"below {self.limit:.3g}" if self.expect.value is None else f"{self.wanted:.12g} +- {self.limit:.2g}"
        off = "" if self.expect.value is None else f" (off by {self.error:.2g})"
        return f"{verdict}: {self.name} = {self.measured:.12g}{off}, expected {what}: {self.expect.because}"


def outcomes(graph: SimulationGraph, variant: str | None = None) -> list[Outcome]:
    """Measure all expectations of a graph for the variant, in one run."""
    held = {name: e for name, e in graph.settings.expect.items() if e.variant == variant}
    if not held:
        return []
    values = [value for e in held.values() for value in (e.of, e.value, e.below) if value is not None]
    times = moments_of(graph, values)
    series = sample(pipeline.simulate(graph, times), times, values)
    return [_outcome(name, expect, series, times) for name, expect in held.items()]


def moments_of(graph: SimulationGraph, values: Iterable[Value]) -> list[float]:
    """The instants [s] at which values are sampled: the film's frames, the end, and those that the values name."""
    clock = graph.settings.clock
    instants = {*clock.frames(clock.fps), clock.end}
    nodes = [node for value in values for node in walk(value.expr)]
    instants |= {instant_of(node) for node in nodes if isinstance(node, Call) and node.op == "at"}
    return sorted(t for t in instants if t <= clock.end)


def sample(moments: Iterable[Moment], times: list[float], values: Iterable[Value]) -> Series:
    """The links of values at the times of a run, each (times, ...); NaN where not needed, since reading may be slow."""
    import numpy as np

    wants: dict[Link, set[float]] = {}
    for value in values:
        for link, when in wanted(value.expr, times[-1:] if plain(value.expr) else times, times):
            wants.setdefault(link, set()).update(when)
    rows: dict[Link, list[Any]] = {link: [] for link in wants}
    for time, moment in zip(times, moments, strict=True):
        for link, row in rows.items():
            row.append(moment.read(link.task, link.output) if time in wants[link] else None)
    return {Symbol("time"): np.array(times), **{link: _filled(row) for link, row in rows.items()}}


def _filled(row: list[Any]) -> Any:
    """Values stacked to (times, ...), NaN where there is none."""
    import numpy as np

    known = [np.asarray(value) for value in row if value is not None]
    if len(known) == len(row):
        return np.array(row)
    blank = np.full(known[0].shape, np.nan)
    return np.array([blank if value is None else value for value in row])


def _outcome(name: str, expect: Expect, series: Series, times: list[float]) -> Outcome:
    import numpy as np

    measured = float(np.max(measure(expect.of.expr, series, times)))
    if expect.value is not None:
        wanted = float(np.max(measure(expect.value.expr, series, times)))
        return Outcome(name, expect, measured, wanted, abs(measured - wanted), float(expect.tolerance.number()))
    assert expect.below is not None
    limit = float(np.max(measure(expect.below.expr, series, times)))
    return Outcome(name, expect, measured, limit, measured, limit)
