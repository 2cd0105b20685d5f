"""References of benchmarks: the script's exact numbers, or a far more accurate run by another method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Expect, Solver
from sceneql.quantities.expression import Call, Expr, Link, Symbol, walk
from sceneql.quantities.operations import OPERATIONS
from sceneql.report.error_measure import ErrorMeasure, name_of
from sceneql.report.work_precision import LONGEST, LOOKS, TOLERANCE, Reference, at, prepared, run
from sceneql.run.series import measure

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.run.instant import Instant
    from sceneql.run.run import IslandRun

TOLERANCES = ((1e-13, 1e-12), (1e-10, 1e-9), (1e-7, 1e-6))
"""Tolerances of the reference and of a second run, whose difference estimates its error; the next pair is used where
these fail."""
METHODS = ("dop853", "dopri5", "radau")
"""Our own methods for references; the first one that reaches the end is used."""
MOST_CALLS = 200_000
"""Largest number of evaluations of the rate by scipy's method: each goes through Python."""
ROUNDING = 1e-14
CONSTANT = 1e-9
"""Range of a quantity, relative to its size, up to which it counts as constant."""


class _TooManyCalls(Exception):
    """scipy's method needs too many evaluations."""


def reference(
    graph: SimulationGraph,
    island: Island,
    catalogue: Catalogue,
    tolerances: Sequence[tuple[float, float]] = TOLERANCES,
    longest: float = LONGEST,
    most_calls: int = MOST_CALLS,
    methods: Sequence[str] = METHODS,
) -> Reference:
    """The reference by exact numbers that the script expects at the end, where these determine the state.

    Else by a run. They do where they are as many as the island's positions and other states except velocities; a single
    number may hide an error (a turning point hides one in time). Otherwise the reference is a run at a far tighter
    tolerance by another method, which is compared with the available exact numbers. Raises RunFailure or LimitRefused
    where no method reaches the end.
    """
    words = [word for word in methods if word in catalogue.words("solvers")]
    own = {word: cast(type[Solver], catalogue.load("solvers", word)).model_validate({}) for word in words}
    exact = {name: e for name, e in graph.settings.expect.items() if _tells_the_end(e, island)}
    if exact:
        from sceneql.run.run import Run

        start = Run(replace(graph, islands=(island,)))
        (moment,) = start.moments([0.0])
        known = sum(_value(expect.of.expr, moment).size for expect in exact.values())
        if known >= _unknowns(start.islands[0]):
            ranges = _ranges(exact, graph, island, own)
            return Reference(
                lambda moment, march: _exact_error(exact, moment, ranges)[0],
                f"exact: {', '.join(exact)}",
                ROUNDING,
                lambda moment, march: _exact_error(exact, moment, ranges)[1],
            )
    failure: RunFailure | LimitRefused | None = None
    for tight, loose in tolerances:
        for word, solver in own.items():
            try:
                seen: list[tuple[float, Floats]] = []
                moment, fine = run(graph, island, at(solver, tight), longest, seen)
                _, coarse = run(graph, island, at(solver, loose), longest)
            except (RunFailure, LimitRefused) as found:  # a method may refuse so many states
                failure = failure or found
                continue
            ranges = _ranges(exact, graph, island, own)
            return _by_runs(word, (moment, fine), coarse, exact, ranges, (tight, loose), most_calls, seen)
    assert failure is not None
    raise failure


def _by_runs(
    word: str,
    fine: tuple[Instant, IslandRun],
    coarse: IslandRun,
    exact: Mapping[str, Expect],
    ranges: Mapping[str, float],
    tolerances: tuple[float, float],
    most_calls: int,
    seen: Sequence[tuple[float, Floats]],
) -> Reference:
    """A reference by our own runs, or by scipy's DOP853 where that is fast enough and nothing acts besides the rate."""
    tight = tolerances[0]
    moment, march = fine
    end, other = _end(march), _end(coarse)
    errors = ErrorMeasure.of(march, _own(march), seen)
    because = f"our own {word} at tolerance {tight:g}"
    if march.assembly.contact_mode != "none":
        because += ": no other method here knows contacts"
    elif march.march.system.structure.after:
        because += ": no other method here knows what happens between steps"
    else:
        with suppress(_TooManyCalls):
            theirs, rough = (_by_dop853(march, tolerance, most_calls) for tolerance in tolerances)
            if errors.error(rough, theirs)[0] <= max(ROUNDING, 10.0 * errors.error(other, end)[0]):
                end, other, because = theirs, rough, f"scipy's DOP853 at rtol {tight:g}"
    if exact:
        off, _ = _exact_error(exact, moment, ranges)
        because += f"; {word} at tight tolerance meets the exact {', '.join(exact)} to {off:.0e}"
    uncertainty = max(ROUNDING, errors.error(other, end)[0])

    def damped(run: IslandRun, looks: Sequence[tuple[float, Floats]]) -> str:
        found = errors.damped(looks)
        if found is None:
            return ""
        return f"it is damped to rest: {name_of(run, found[1])} moves {found[0]:.1g} of what it does in truth"

    return Reference(
        lambda moment, run: errors.error(_end(run), end)[0],
        because,
        uncertainty,
        lambda moment, run: name_of(run, errors.error(_end(run), end)[1]),
        damped,
    )


def _unknowns(island: IslandRun) -> int:
    """Number of states of an island without velocities and tallies of energy."""
    partner = island.march.system.partner
    bodies = sum(bodies is not None for bodies in island.bodies.values())
    return int(_own(island).sum()) - int((partner >= 0).sum()) - bodies


def _tells_the_end(expect: Expect, island: Island) -> bool:
    """Whether an expectation is an exact value of this island at the end of the run."""
    if expect.value is None or "exact" not in expect.because or expect.variant is not None:
        return False
    nodes = list(walk(expect.of.expr))
    series = {node.op for node in nodes if isinstance(node, Call) and OPERATIONS[node.op].series}
    links = {node.task for node in nodes if isinstance(node, Link)}
    return series == {"final"} and bool(links) and links <= {*island.models, *(name for name, _, _ in island.contacts)}


def _value(expr: Expr, moment: Instant) -> Floats:
    """The value of an expectation's expression at the end of a run."""
    import numpy as np

    times = [moment.time]
    series: dict[Symbol | Link, Floats] = {Symbol("time"): np.array(times)}
    for node in walk(expr):
        if isinstance(node, Link):
            series[node] = np.array([moment.read(node.task, node.output)])
    return np.asarray(measure(expr, series, times), dtype=np.float64)


def _ranges(
    exact: Mapping[str, Expect], graph: SimulationGraph, island: Island, own: Mapping[str, Solver]
) -> dict[str, float]:
    """The range over the run of each expected quantity, by the first method that reaches the end."""
    import numpy as np

    from sceneql.run.run import Run

    end = graph.settings.clock.end
    for solver in own.values() if exact else ():
        with suppress(RunFailure, LimitRefused):
            moments = Run(prepared(graph, island, at(solver, TOLERANCE))).moments(
                [end * k / LOOKS for k in range(LOOKS + 1)]
            )
            found = [[_value(expect.of.expr, moment) for expect in exact.values()] for moment in moments]
            return {
                name: float(np.ptp(np.array(values), axis=0).max(initial=0.0))
                for name, values in zip(exact, zip(*found, strict=True), strict=True)
            }
    return {}


def _exact_error(expectations: Mapping[str, Expect], moment: Instant, ranges: Mapping[str, float]) -> tuple[float, str]:
    """Largest error of the expected numbers, each relative to its range over the run, and that expectation's name.

    A constant quantity has no range: its error is relative to its value.
    """
    import numpy as np

    worst = (0.0, next(iter(expectations)))
    for name, expect in expectations.items():
        if expect.value:
            got, wanted = _value(expect.of.expr, moment), _value(expect.value.expr, moment)
            size = float(np.max(np.abs(wanted)))
            moved = ranges.get(name, 0.0)
            scale = moved if moved > CONSTANT * size else size or 1.0
            worst = max(worst, (float(np.max(np.abs(got - wanted))) / scale, name))
    return worst


def _by_dop853(island: IslandRun, tolerance: float, most_calls: int) -> Floats:
    """The final state of an island by scipy's DOP853 (Hairer, Norsett & Wanner 1993, II.5) on the compiled rate."""
    import numpy as np
    from scipy.integrate import solve_ivp

    march = island.march
    start = march.system.y
    scale = np.maximum(np.abs(start), 1e-3 * np.abs(_end(island)).max(initial=1e-300))
    calls = 0

    def rate(t: float, y: Floats) -> Floats:
        nonlocal calls
        calls += 1
        if calls > most_calls:
            raise _TooManyCalls
        return march.rate(t, y)

    found = solve_ivp(rate, (0.0, march.end), start, method="DOP853", rtol=tolerance, atol=tolerance * scale)
    if not found.success:
        raise _TooManyCalls
    return np.asarray(found.y[:, -1], dtype=np.float64)


def _end(island: IslandRun) -> Floats:
    y, _ = island.march.advance(island.march.end)
    return y


def _own(island: IslandRun) -> NDArray[bool_]:
    """(n,) bool: entries of the state that belong to models (contacts keep records there, too)."""
    import numpy as np

    own = np.zeros(len(island.march.system.y), dtype=bool)
    for first, last, part, _ in island.march.system.ranges:
        own[first:last] = part in island.island.models
    return own
