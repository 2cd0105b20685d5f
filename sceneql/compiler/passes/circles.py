"""Check for circular links: values and objects that depend on themselves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Model, Object
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span

Place = tuple[str, str]
"""(part, one of its fields or outputs); "" is the part as a whole."""


def report_circles(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report links, and objects that contain objects, that lead back to where they start.

    The outputs of a solved model come from its state: no circle goes through one.
    """
    done: set[Place] = set()
    needs = _Needs(tasks)
    for task in tasks.values():
        starts = [(task.name, "")]
        if isinstance(task.kind, Object):
            starts += [(task.name, field) for field in type(task.kind).model_fields]
        for start in starts:
            _walk(start, needs, done, found)


def _walk(start: Place, needs: _Needs, done: set[Place], found: Diagnostics) -> None:
    """Depth-first search for circles, without recursion: a chain of links may be long."""
    path: list[Place] = []
    stack: list[tuple[Place, Span | None, bool]] = [(start, None, False)]
    while stack:
        place, span, leaving = stack.pop()
        if leaving:
            path.pop()
            done.add(place)
        elif place in path:
            circle = " -> ".join(".".join(part for part in one if part) for one in [*path[path.index(place) :], place])
            found.error("circular-link", f"this needs itself: {circle}", span, help=_way_out(place))
        elif place not in done:
            path.append(place)
            stack.append((place, span, True))
            stack += [(other, where, False) for other, where in needs.of(place)]


def _way_out(place: Place) -> str:
    if not place[1]:
        return "an object holds no part that it is in: leave one of these names out"
    return f"write one of these values without the others: a number for `{'.'.join(place)}`, or a formula of `time`"


class _Needs:
    """The dependences of places. All outputs of a kinematic model read what the model does, looked up once."""

    def __init__(self, tasks: Mapping[str, Task]) -> None:
        self.tasks = tasks
        self.of_parts: dict[str, list[tuple[Place, Span | None]]] = {}

    def of(self, place: Place) -> Iterable[tuple[Place, Span | None]]:
        kind = self.tasks[place[0]].kind
        if isinstance(kind, Model) and not kind.kinematic:
            return []
        if isinstance(kind, Object):
            if not place[1]:
                return [((ref.name, ""), ref.span) for ref in kind.members()]
            return _read(getattr(kind, place[1], None))
        if place[0] not in self.of_parts:
            self.of_parts[place[0]] = _read(kind)
        return self.of_parts[place[0]]


def _read(part: object) -> list[tuple[Place, Span | None]]:
    return [((link.task, link.output), link.span) for value in values_of(part) for link in value.links]
