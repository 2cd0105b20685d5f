"""A warning about unbounded objects whose bounds the script does not give."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_bounds(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each object that its own default bounds cut."""
    for task in tasks.values():
        where, bounds = task.kind.cut_by_default() if isinstance(task.kind, Object) else ("", "")
        if where:
            help = "give it `bounds`, as large as it is: `bounds: {ball: 2}`, or `{box: [-2 -2 -2, 2 2 2]}`"
            help = f"write `{bounds}`" if bounds else help
            message = f"'{task.name}' is cut by {where}, where it goes on: nothing says how far"
            found.warning("unset-bounds", message, task.span, help=help)
