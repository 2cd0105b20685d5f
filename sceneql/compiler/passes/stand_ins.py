"""Models that stand in place of the objects that they are made of: a soft body is seen and hit, not its mold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from sceneql.graph import Task
from sceneql.kinds import Model, Ref

LOOKS = ("material", "color")


def stand_ins(tasks: Mapping[str, Task]) -> dict[str, Task]:
    """The parts, with objects hidden that only models are made of; these models take over their material and color."""
    made = {task.name: _shapes(task) for task in tasks.values() if isinstance(task.kind, Model)}
    others = {need for task in tasks.values() if not made.get(task.name) for need in task.needs}
    result = dict(tasks)
    for name, refs in made.items():
        for ref in refs:
            shape: Any = tasks[ref.name].kind
            if ref.name in others or shape.hidden:
                continue
            result[ref.name] = replace(tasks[ref.name], kind=shape.model_copy(update={"hidden": True}))
            body = result[name]
            has = [look for look in LOOKS if look in type(body.kind).model_fields]
            if has and all(getattr(body.kind, look) is None for look in has):
                update = {look: getattr(shape, look) for look in has}
                more = [value.name for value in update.values() if isinstance(value, Ref)]
                result[name] = replace(body, kind=body.kind.model_copy(update=update), needs=(*body.needs, *more))
    return result


def _shapes(task: Task) -> tuple[Ref, ...]:
    """The objects of which a model is made that draws itself; for models shown by field maps none."""
    assert isinstance(task.kind, Model)
    return () if task.kind.shows(task.name) is not None else tuple(task.kind.shown_in_place_of())
