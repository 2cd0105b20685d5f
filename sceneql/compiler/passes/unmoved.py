"""Objects that a model takes as they are at the start must not move: refused before anything runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics

HELP = "give it one place and shape; let the fluid stream past it instead"


def report_moving(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report values that vary in time of objects that a model takes as they are at the start, and of their members."""
    for task in tasks.values():
        for ref in task.kind.standing() if isinstance(task.kind, Model) else ():
            for name, field, value in _varying(tasks[ref.name], tasks):
                which = f"'{ref.name}'" if name == ref.name else f"'{name}' in '{ref.name}'"
                text = f"'{task.name}' has cells cut by {which} as it is at the start, but its {field} varies in time"
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
