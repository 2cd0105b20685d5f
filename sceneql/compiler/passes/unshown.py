"""Warnings of models that are left out because all of their objects are hidden."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from sceneql.graph import Task
from sceneql.kinds import Model, Object, Output
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_unshown(
    tasks: Mapping[str, Task], kept: Collection[str], expected: Collection[str], found: Diagnostics
) -> None:
    """Warn of models that pictures of everything leave out, whose objects are all hidden.

    ``kept``: the parts that outputs need; ``expected``: those that `expect` measures.
    """
    outputs = [task.kind for task in tasks.values() if isinstance(task.kind, Output)]
    if not any(kind.draws and kind.shown() is None for kind in outputs):
        return
    for task in tasks.values():
        if not isinstance(task.kind, Model) or task.name in kept or task.name in expected:
            continue
        moved = [name for name in task.kind.drives() if name in tasks]
        hidden = [name for name in moved if isinstance(kind := tasks[name].kind, Object) and kind.hidden]
        if hidden and hidden == moved:
            one = hidden[0]
            text = f"'{task.name}' is left out: nothing shows or measures it, as '{one}', which it moves, is hidden"
            members = any(kind.members() for name in hidden if isinstance(kind := tasks[name].kind, Object))
            help = f"leave out `hidden: yes` of '{one}'" + (": it is drawn in place of its parts" if members else "")
            found.warning("not-shown", text, task.span, help=help)
