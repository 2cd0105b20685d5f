"""Warnings of doubtful settings that models and objects find in their own fields."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Clock, Model, Object
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_doubts(tasks: Mapping[str, Task], clock: Clock, found: Diagnostics) -> None:
    """Warn of each doubt of a model or an object."""
    for task in tasks.values():
        kind = task.kind
        doubts = kind.doubts() if isinstance(kind, Model) else kind.doubts(clock) if isinstance(kind, Object) else ()
        for doubt in doubts:
            found.warning(doubt.code, f"'{task.name}': {doubt.text}", doubt.place or task.span, help=doubt.help)
