"""Shapes of what holds bodies to the world: a pin on a hinge, a bead on a ball joint, where nothing else stands."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from sceneql.bodies.spring_look import HOLDER
from sceneql.failure import RunFailure
from sceneql.frame import Points, Quadric, Segments
from sceneql.kinds import Object, Tie, Value
from sceneql.shapes.outlines import outline
from sceneql.shapes.placement import unit_vector
from sceneql.shapes.world_boxes import surface_box

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.graph import SimulationGraph, Task
    from sceneql.run.instant import Instant

PIN, BEAD = 0.4, 0.65
"""Radii of pins and beads, relative to the smallest width of the body that they hold."""
OUT = 0.8
"""How far a pin comes out of the body on each side, relative to the same."""
LEAST, MOST = 0.012, 0.06
"""Least and largest radius, relative to the body's length."""
BUILT, SHORT = 0.02, 4.0
"""Largest radius of one on a body of several parts, whose width at the place is not known, relative to its length; and
largest half length of a pin there, in radii."""
NEAR = 0.05
"""Distance from a box, relative to the length of the body that is held, at which a place counts as in it."""


Support = tuple[str, "Shape"]
"""The name of an object, and a shape that holds it."""


def supports(graph: SimulationGraph, start: Callable[[], Instant]) -> list[Support]:
    """The supports of a graph's ties to the world, at constant places on objects that the tied bodies move.

    None at a place that is in the box of an object at rest, which holds the body to the eye. ``start``: an instant at
    the start of a run without solved states.
    """
    ties = [
        (task, held) for task in graph.tasks.values() if isinstance(task.kind, Tie) and (held := task.kind.support())
    ]
    if not ties:
        return []
    moment = start()
    still = [box for box in _boxes(graph, moment) if np.isfinite(box).all()]
    return [one for task, held in ties if (one := _support(graph, task, held, moment, still)) is not None]


def _support(
    graph: SimulationGraph, task: Task, held: tuple[Value, Value | None], moment: Instant, still: Sequence[Floats]
) -> Support | None:
    """The support of a tie; ``still``: boxes (2, 3) [m] of what is at rest."""
    at, axis = held
    if not at.constant or (axis is not None and not axis.constant):
        return None
    point, along = np.array(at.number()), None if axis is None else unit_vector(np.array(axis.number()))
    for name, points, plain in _moved(graph, cast(Tie, task.kind), moment):
        box = np.array([points.min(axis=0), points.max(axis=0)])
        room = NEAR * float(np.ptp(box, axis=0).max())
        if _within(point, box, room):
            hidden = any(_within(point, other, room) for other in still)
            return None if hidden else (name, _shape(task, points, point, along, plain))
    return None


def _within(point: Floats, box: Floats, room: float) -> bool:
    """Whether a point (3,) is at most so far [m] outside of a box (2, 3)."""
    return bool((point >= box[0] - room).all() and (point <= box[1] + room).all())


def _boxes(graph: SimulationGraph, moment: Instant) -> Iterator[Floats]:
    """Boxes (2, 3) [m] of what is drawn and does not move."""
    for name in moment.everything:
        task = graph.tasks[name]
        if isinstance(task.kind, Object) and task.original is None:
            moment.asked = False
            try:
                drawn = moment.lower([name])
            except (RunFailure, KeyError):  # it reads a solved state
                continue
            if not moment.asked:
                yield from (np.array(surface_box(shape)) for shape in drawn)


def _moved(graph: SimulationGraph, tie: Tie, moment: Instant) -> Iterator[tuple[str, Floats, bool]]:
    """Objects that the bodies of a tie move: name, points (n, 3) [m] at the start, whether it is one plain solid."""
    models = {ref.name for ref in tie.between}
    for name in moment.everything:
        task = graph.tasks[name]
        if isinstance(task.original, Object) and models.intersection(task.needs):
            drawn = list(task.original.lower(name, np.eye(3, 4), moment))
            points = np.concatenate([np.zeros((0, 3)), *map(outline, drawn)])
            if len(points):
                yield name, points, len(drawn) == 1 and isinstance(drawn[0], Quadric)


def _shape(task: Task, points: Floats, place: Floats, axis: Floats | None, plain: bool) -> Shape:
    """A pin along an axis (3,) through points (n, 3) of a body, or a bead."""
    away = points - points.mean(axis=0)
    sides = np.ptp(away @ np.linalg.eigh(away.T @ away)[1], axis=0)
    least, most = LEAST * float(sides.max()), (MOST if plain else BUILT) * float(sides.max())
    name, width = f"{task.name}.support", float(sides.min())
    if axis is None:
        return Points(name, HOLDER, place[None], np.array([min(max(BEAD * width, least), most)]))
    radius = min(max(PIN * width, least), most)
    along, out = (points - place) @ axis, OUT * radius / PIN
    far = np.inf if plain else SHORT * radius
    ends = max(along.min() - out, -far), min(along.max() + out, far)
    return Segments(name, HOLDER, np.array([[place + end * axis for end in ends]]), np.array([radius]))
