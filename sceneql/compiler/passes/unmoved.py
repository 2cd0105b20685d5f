"""Objects whose shape a model takes as it is at the start must not change it: refused before anything runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics

HELP = "let it move or turn as a whole: by its own `position` and `rotation`"
PLACES = ("position", "rotation")
"""Fields of an object that move it as a whole."""


def report_moving(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report values that vary in time of objects whose shape a model takes, and of their members."""
    for task in tasks.values():
        for ref in task.kind.shaped() if isinstance(task.kind, Model) else ():
            for name, field, value in _varying(tasks[ref.name], tasks):
                if name == ref.name and field in PLACES:
                    continue
                which = f"'{ref.name}'" if name == ref.name else f"'{name}' in '{ref.name}'"
                text = (
                    f"'{task.name}' has cells cut by {which} in its shape at the start, but its {field} varies in time"
                )
                found.error("moves", text, value.span or ref.span, help=HELP)


def _varying(task: Task, tasks: Mapping[str, Task]) -> Iterator[tuple[str, str, Value]]:
    """The object, field and value of each that varies in time, but of fields that all objects have (how they look)."""
    stack, seen = [task], set[str]()
    while stack:
        one = stack.pop()
        if not isinstance(one.kind, Object) or one.name in seen:
            continue
        seen.add(one.name)
        for name, content in one.kind:
            if name not in Object.model_fields:
                yield from ((one.name, name, value) for value in values_of(content) if not value.constant)
        stack += [tasks[ref.name] for ref in reversed(one.kind.members())]
