"""Which dynamic models a part's values depend on."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Interaction, Model, Object


def reads(name: str, tasks: Mapping[str, Task]) -> tuple[str, ...]:
    """The dynamic models that a part's values depend on, through objects and kinematic models.

    The models that a force acts on are not among them for that reason alone.
    """
    found: dict[str, None] = {}
    stack, seen = _needs(tasks[name]), {name}
    while stack:
        other = stack.pop()
        if other in seen or other not in tasks:
            continue
        seen.add(other)
        kind = tasks[other].kind
        if isinstance(kind, Model) and not kind.kinematic:
            found[other] = None
        elif isinstance(kind, Model | Object) and not _driven_by(name, other, tasks):
            stack.extend(tasks[other].needs)
    return tuple(found)


def _driven_by(model: str, name: str, tasks: Mapping[str, Task]) -> bool:
    kind = tasks[model].kind
    return isinstance(kind, Model) and name in kind.drives()


def _needs(task: Task) -> list[str]:
    acted_on = set(task.kind.targets() or ()) if isinstance(task.kind, Interaction) else set()
    linked = {link.task for value in values_of(task.kind) for link in value.links} if acted_on else set()
    return [name for name in task.needs if name in linked or name not in acted_on]
