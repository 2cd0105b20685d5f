"""Warnings of models that are left out because all of their objects are hidden, and of cameras that draw nothing."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from sceneql.graph import Task
from sceneql.kinds import Camera, Model, Object, Output, Picture
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


def warn_of_unused_cameras(tasks: Mapping[str, Task], kept: Collection[str], found: Diagnostics) -> None:
    """Warn of cameras that no picture is seen from, where pictures take the script's first one by themselves.

    ``kept``: the parts that outputs need.
    """
    pictures = [task for task in tasks.values() if isinstance(task.kind, Picture)]
    cameras = [task for task in tasks.values() if isinstance(task.kind, Camera) and task.span is not None]
    taking = [task for task in pictures if task.kind.camera is None]  # type: ignore[attr-defined]
    for task in cameras[1:] if taking else ():
        if task.name not in kept:
            one = taking[0]
            name = one.name if one.span is not None else "film"
            first = f"pictures without a `camera` are from '{cameras[0].name}', the first"
            text = f"nothing is seen from '{task.name}': {first}"
            help = f"write `outputs: {{{name}: {{{one.word}: {{camera: {task.name}}}}}}}`, or leave '{task.name}' out"
            found.warning("unused-camera", text, task.span, help=help)
