"""Check of lists whose length is known before the run and is too large for their object."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Link


def check_sizes(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report lists that are longer than their object can take."""

    def count(value: Value) -> int | None:
        """Number of items of a value; None where only the run knows it."""
        shape = value.expr.type.shape
        if shape and shape[0] is not None:
            return shape[0]
        if not isinstance(value.expr, Link) or value.expr.task not in tasks:
            return None
        source = tasks[value.expr.task].kind
        return source.items(value.expr.output) if isinstance(source, Model) else None

    for task in tasks.values():
        if isinstance(task.kind, Object):
            for value, message in task.kind.excess(count):
                found.error("limit-refused", f"{task.name}: {message}", value.span or task.span)
