"""Which dynamic models a part's values depend on."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Model, Object


def reads(name: str, tasks: Mapping[str, Task]) -> tuple[str, ...]:
    """The dynamic models that a part's values depend on, through objects and kinematic models."""
    found: dict[str, None] = {}
    stack, seen = list(tasks[name].needs), {name}
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
