"""Warnings of doubtful settings that models, lights and objects find in their own fields."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Clock, Light, Model, Object
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_doubts(tasks: Mapping[str, Task], clock: Clock, found: Diagnostics) -> None:
    """Warn of each doubt of a model, a light or an object."""
    grounded = any(isinstance(task.kind, Object) and task.kind.grounds for task in tasks.values())
    for task in tasks.values():
        kind = task.kind
        doubts = kind.doubts() if isinstance(kind, Model) or (grounded and isinstance(kind, Light)) else ()
        doubts = kind.doubts(clock) if isinstance(kind, Object) else doubts
        for doubt in doubts:
            found.warning(doubt.code, f"'{task.name}': {doubt.text}", doubt.place or task.span, help=doubt.help)
