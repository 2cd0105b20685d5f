"""The default floor for contacts, lowered under the lowest object; how low is known from the objects' shapes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, cast

from sceneql.frame import Implicit
from sceneql.kinds import Model, Value
from sceneql.quantities.dimension import LENGTH
from sceneql.quantities.expression import Number, Type
from sceneql.shapes.world_boxes import surface_box

if TYPE_CHECKING:
    from sceneql.frame import Shape
    from sceneql.graph import SimulationGraph
    from sceneql.run.instant import Instant

ROUNDS = 4
"""Number of times that the lowest part of an implicit solid's box is sampled anew."""
PART = 1 / 8
"""Height of that part, relative to the box."""


def grounded(graph: SimulationGraph, start: Callable[[], Instant]) -> SimulationGraph:
    """The graph, its default floor lowered under each object at ``start`` that contacts touch and no model moves."""
    touched = sorted({name for island in graph.islands for _, _, others in island.contacts for name in others})
    floors = [name for name in touched if graph.tasks[name].span is None]
    if len(floors) != 1:
        return graph
    floor = graph.tasks[floors[0]]

    @cache
    def driven(name: str) -> bool:
        task = graph.tasks[name]
        return (isinstance(task.kind, Model) and not task.kind.kinematic) or any(map(driven, task.needs))

    others = [n for n in touched if n != floor.name and not getattr(graph.tasks[n].kind, "hidden", True)]
    shapes = start().lower([name for name in others if not driven(name)])
    level = float(cast(Any, floor.kind).height.number())
    lowest = min([level, *map(_lowest, shapes)])
    if lowest == level:
        return graph
    moved = floor.kind.model_copy(update={"height": Value(Number(lowest, Type((), LENGTH)))})
    return replace(graph, tasks={**graph.tasks, floor.name: replace(floor, kind=moved)})


def _lowest(shape: Shape) -> float:
    """Height [m] of a shape's lowest point, infinite where it has none; for an implicit solid by sampling."""
    low, high = surface_box(shape)
    if isinstance(shape, Implicit):
        for _ in range(ROUNDS):
            top = low[1] + PART * (high[1] - low[1])
            low, high = surface_box(replace(shape, low=tuple(low), high=(high[0], top, high[2])))
    return float(low[1]) if abs(low[1]) < float("inf") else float("inf")
