"""Objects that are the shape of several bodies: each body but the first drives a copy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sceneql.graph import Task
from sceneql.kinds import Model, Ref


def own_shapes(tasks: Mapping[str, Task]) -> dict[str, Task]:
    """The parts, with a copy ``brick.1`` for the second body that has the shape ``brick``, and so on."""
    result, taken = dict(tasks), set[str]()
    for task in tasks.values():
        if not isinstance(task.kind, Model):
            continue
        copies: list[str] = []

        def own(ref: Ref, copies: list[str] = copies) -> Ref:
            if ref.name not in taken:
                taken.add(ref.name)
                return ref
            number = 1
            while (name := f"{ref.name}.{number}") in result:
                number += 1
            result[name] = replace(tasks[ref.name], name=name)
            copies.append(name)
            return replace(ref, name=name)

        kind = task.kind.with_own_shapes(own)
        if copies:
            result[task.name] = replace(task, kind=kind, needs=(*task.needs, *copies))
    return result
