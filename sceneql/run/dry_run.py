"""The dry run before the film's own run: bounds of all that is drawn, and values over the whole run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.doing import doing
from sceneql.failure import RunFailure
from sceneql.graph import SimulationGraph
from sceneql.kinds import Camera, Clock, Object, Overlay, Value
from sceneql.quantities.expression import Call, Expr, Keys, Link, Symbol, children, holders, rebuilt
from sceneql.quantities.operations import OPERATIONS
from sceneql.run.leaving import Leaving, Paths, let_go
from sceneql.run.series import course
from sceneql.shapes.outlines import outermost, outline
from sceneql.shapes.world_boxes import surface_box

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.run.instant import Instant, Running

    Bounds = dict[str, tuple[Floats, Floats]]

BOUNDS_EVERY = 12
BOUNDS_STEPS = 48
"""Number of instants at which bounds are taken; values are taken BOUNDS_EVERY times as often."""


@dataclass(frozen=True, slots=True)
class DryRun:
    """The results of a dry run, up to its end or its failure."""

    bounds: Bounds | None
    """Low and high corner (3,) of each part over the run; None: not asked for."""
    times: list[float]
    rows: Mapping[int, Floats]
    """(times, ...) values of the requested subexpressions, by their id."""
    leaving: Sequence[Leaving] = ()
    """The moving things that leave the scene for good."""
    staying: tuple[Floats, Floats] | None = None
    """Low and high corner (3,) of everything else; None where nothing leaves."""
    outlines: Mapping[str, Floats] = field(default_factory=dict)
    """Points (n, 3) [m] by part, whose hull encloses the part over the run (outlines.outline)."""
    moving: Sequence[tuple[float, Floats]] = ()
    """Instants [s], and points (n, 3) [m] whose hull encloses all parts that may change at each."""
    changing: Sequence[str] = ()
    """Those parts."""

    def course(self, expr: Expr, until: float) -> tuple[Floats, Floats]:
        """Times (n,) [s] up to ``until``, and values (n, ...) of an expression that was requested (`asked`)."""
        count = max(1, int(np.searchsorted(self.times, until, side="right")))
        series: dict[Symbol | Link, Any] = {}

        def known(old: Expr, node: Expr) -> Expr:
            if id(old) not in self.rows:
                return node
            symbol = Symbol(f"piece {id(old)}", old.type)
            series[symbol] = self.rows[id(old)][:count]
            return symbol

        def below(node: Expr) -> tuple[Expr, ...]:
            return () if id(node) in self.rows or isinstance(node, Keys) else children(node)

        values = course(rebuilt(expr, known, below), series, self.times[:count])
        one = np.shape(values)[np.ndim(values) - len(expr.type.shape) :]
        return np.array(self.times[:count]), np.broadcast_to(values, (count, *one))


def pieces(expr: Expr) -> Iterator[Expr]:
    """The largest subexpressions without operations over the run, constants left out."""
    over_time = holders(lambda node: isinstance(node, Call) and OPERATIONS[node.op].series, expr)
    varying = holders(lambda node: isinstance(node, Symbol | Link), expr)
    stack, known = [expr], set[int]()
    while stack:
        node = stack.pop()
        if id(node) not in known:
            known.add(id(node))
            if id(node) in over_time:
                stack.extend(reversed(children(node)))
            elif id(node) in varying:
                yield node


def asked(graph: SimulationGraph) -> dict[tuple[str, int], Value]:
    """The values whose course overlays request, by the overlay's name and the value's index."""
    overlays = [(name, task.kind) for name, task in graph.tasks.items() if isinstance(task.kind, Overlay)]
    return {(name, k): value for name, kind in overlays for k, value in enumerate((*kind.courses(), *kind.fades()))}


def asked_by_objects(start: Instant) -> dict[str, list[Value]]:
    """The values whose course objects request, found from the run's start, by the objects' names."""
    objects = {name: task.kind for name, task in start.run.graph.tasks.items() if isinstance(task.kind, Object)}
    return {name: values for name, kind in objects.items() if (values := list(kind.courses(start)))}


@doing("running ahead of the film")
def dry_run(ahead: Running, *, bounded: bool = True) -> DryRun:
    """March a fresh run to its end for bounds and values over the whole run, as cameras and overlays need them.

    Where the run fails, the bounds are those of the start alone, since a state that explodes fits into no picture. The
    shapes of a part that reads nothing varying at the start are evaluated only there.
    """
    graph = ahead.graph
    wanted = over_time = list(asked(graph).values())
    bounded = bounded or any(isinstance(t.kind, Camera) and t.kind.looks_ahead() for t in graph.tasks.values())
    start: Bounds = {}
    now: Bounds = {}
    changing: list[str] = []
    times: list[float] = []
    asked_for: dict[int, Value] = {}
    rows: dict[int, list[Any]] = {}
    first: dict[str, Floats] = {}
    paths = Paths()
    outlines: dict[str, Floats] = {}
    moving: list[tuple[float, Floats]] = []
    every = 1

    def instants() -> Iterator[float]:
        """The start, then the instants of the rest; their number is known from the start."""
        yield 0.0
        steps = BOUNDS_STEPS * every
        yield from (graph.settings.clock.end * k / steps for k in range(1, steps + 1))

    try:
        for k, moment in enumerate(ahead.moments(instants())):
            if k == 0:
                wanted = [*over_time, *chain.from_iterable(asked_by_objects(moment).values())]
                asked_for = {id(piece): Value(piece) for value in wanted for piece in pieces(value.expr)}
                rows = {key: [] for key in asked_for}
                every = BOUNDS_EVERY if over_time else _often(graph.settings.clock) if wanted else 1
            if bounded and k == 0:
                shapes = {}
                for name in ahead.orders:
                    moment.asked = False
                    drawn = moment.lower([name])
                    start = _widened(start, {name: drawn}, ahead.holders)
                    _outline(outlines, {name: drawn})
                    if moment.asked:
                        changing.append(name)
                        shapes[name] = drawn
                now, first = start, dict(outlines)
                paths.see(moment.now, shapes)
                moving.append((moment.now, _around_all(outlines[name] for name in changing)))
            elif bounded and k % every == 0:
                shapes = {name: moment.lower([name]) for name in changing}
                now = _widened(now, shapes, ahead.holders)
                own: dict[str, Floats] = {}
                _outline(own, shapes)
                _join(outlines, own)
                paths.see(moment.now, shapes)
                moving.append((moment.now, _around_all(own.values())))
            for key, piece in asked_for.items():
                rows[key].append(moment.measure(piece))
            times.append(moment.now)
            if not changing and not wanted:
                break
    except RunFailure:
        if not times:
            raise
        now, paths, outlines, moving = start, Paths(), first, moving[:1]
    count = len(times)
    values = {key: np.array(row[:count]) for key, row in rows.items()}
    if not bounded:
        return DryRun(None, times, values)
    still = [now[name] for name in ahead.orders if name in now and name not in changing]
    return DryRun(now, times, values, *let_go(paths, still), outlines, moving, changing)


def _often(clock: Clock) -> int:
    """Instants for each one at which bounds are taken, so that there are about as many as frames."""
    return min(BOUNDS_EVERY, math.ceil(len(clock.frames(clock.fps)) / BOUNDS_STEPS))


def _widened(bounds: Bounds, shapes: Mapping[str, Sequence[Shape]], holders: Mapping[str, str]) -> Bounds:
    """The bounds, widened by the shapes of some parts at a moment."""
    result = dict(bounds)
    for name, drawn in shapes.items():
        for shape in drawn:
            low, high = surface_box(shape)
            if np.isfinite(low).all() and np.isfinite(high).all():
                for part in {name, *_around(shape.name, holders)}:
                    old = result.get(part, (low, high))
                    result[part] = np.minimum(old[0], low), np.maximum(old[1], high)
    return result


def _outline(outlines: dict[str, Floats], shapes: Mapping[str, Sequence[Shape]]) -> None:
    """Write the outlines of some parts at a moment, from their shapes."""
    for name, drawn in shapes.items():
        outlines[name] = _around_all(map(outline, drawn))


def _join(outlines: dict[str, Floats], more: Mapping[str, Floats]) -> None:
    """Widen outlines of parts by those at another moment."""
    for name, points in more.items():
        outlines[name] = _around_all([outlines[name], points] if name in outlines else [points])


def _around_all(points: Iterable[Floats]) -> Floats:
    """The outermost of several arrays of points (n, 3)."""
    return outermost(np.concatenate([np.zeros((0, 3)), *points]))


def _around(name: str, holders: Mapping[str, str]) -> Iterator[str]:
    """A part and its holders, from the inside out."""
    while name:
        yield name
        name = holders.get(name, "")
