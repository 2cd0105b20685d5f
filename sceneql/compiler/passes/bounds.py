"""A warning about unbounded objects whose bounds the script does not give."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_bounds(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each object that its own default bounds cut."""
    for task in tasks.values():
        if isinstance(task.kind, Object) and (where := task.kind.cut_by_default()):
            help = "give it `bounds`, as large as it is: `bounds: {ball: 2}`, or `{box: [-2 -2 -2, 2 2 2]}`"
            message = f"'{task.name}' is cut by {where}, where it goes on: nothing says how far"
            found.warning("unset-bounds", message, task.span, help=help)
