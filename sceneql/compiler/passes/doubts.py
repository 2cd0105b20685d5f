"""Warnings of what models themselves find doubtful in their fields."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_doubts(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each doubt of a model."""
    for task in tasks.values():
        for doubt in task.kind.doubts() if isinstance(task.kind, Model) else ():
            found.warning(doubt.code, f"'{task.name}': {doubt.text}", doubt.place or task.span, help=doubt.help)
