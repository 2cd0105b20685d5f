"""Warnings of ties that hold a body at a point far outside of it, as in wrong coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from sceneql.compiler.passes.fillings import Beginning
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Task
from sceneql.kinds import Model, Ref, Tie
from sceneql.quantities.diagnostic import Diagnostics, ScriptError

FAR, FAR_OF_BOB = 1.0, 20.0
"""Distance from the body's box, relative to its diagonal, from which on a point is far; a compact bob may hang on a
long arm."""
BOB = 2.0
"""Largest ratio of the sides of a bob's box."""


def warn_of_far_joints(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each tie whose point is far outside of its body's object, if the script determines both at the start."""
    ties = [task for task in tasks.values() if isinstance(task.kind, Tie)]
    start: Any = Beginning(tasks)
    for task in ties:
        for place, refs in task.kind.places() if isinstance(task.kind, Tie) else ():
            for ref in refs:
                try:
                    far = next(_outside(start.at(place), ref, tasks, start), None)
                except (TypeError, ValueError, ArithmeticError, RunFailure, LimitRefused, ScriptError):
                    continue  # only a run knows
                if far is not None:
                    distance, where = far
                    which = ref.within or ref.name
                    text = f"'{task.name}' holds '{which}' {distance:.3g} m outside of it"
                    help = f"this is a place in the world, where '{which}' goes from {where} m; a string is a `rod`"
                    found.warning("far-joint", text, place.span or task.span, help=help)


def _outside(place: Any, ref: Ref, tasks: Mapping[str, Task], start: Any) -> Iterator[tuple[float, str]]:
    """The distance [m] of a point from the box of a body's object, and that box in words; nothing where it is near."""
    import numpy as np

    model: Any = tasks[ref.name].kind if ref.name else None
    for name, fields in model.drives().items() if isinstance(model, Model) else ():
        body = (getattr(model, "bodies", None) or {}).get(ref.within, model)
        placed = getattr(body, "position", None) is not None  # not where its object stands
        if placed or fields.get("position", "").rpartition(".")[0] != ref.within:
            continue
        kind: Any = tasks[name].original or tasks[name].kind
        low, high = kind.extent(np.eye(3, 4), start)
        distance = float(np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0)))
        far = FAR_OF_BOB if (high - low).max() <= BOB * (high - low).min() else FAR
        if distance > far * float(np.linalg.norm(high - low)):
            yield distance, " to ".join(", ".join(f"{x:.4g}" for x in corner) for corner in (low, high))
