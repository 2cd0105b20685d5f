"""Warnings of objects that collide as a ball of no size of their own, and of objects that two models move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from sceneql.graph import Island, Task
from sceneql.kinds import Model, Value
from sceneql.quantities.diagnostic import Diagnostics

SIZES = ("radius", "size")
"""Fields of an object by which a particle knows its radius."""


def warn_of_balls(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Warn of contacts of a particle that is an object without a size, and so a ball of the default radius."""
    touching = {model for island in groups for _, model, _ in island.contacts}
    for task in tasks.values():
        if not isinstance(task.kind, Model) or task.name not in touching or task.kind.turns:
            continue
        if "radius" not in type(task.kind).model_fields or getattr(task.kind, "radius", None) is not None:
            continue
        for name in task.kind.drives():
            kind = tasks[name].original or tasks[name].kind
            if not any(isinstance(getattr(kind, field, None), Value) for field in SIZES):
                text = f"in contacts '{name}' is a ball of 5 cm about its position, as it has no radius"
                shape = f"collides with its whole shape, and turns: `{{rigid: {{of: {name}, mass: 1 kg}}}}`"
                help = f"give '{task.name}' a `radius`, or let it be a rigid body, which {shape}"
                found.warning("as-ball", text, task.span, help=help)


def warn_of_two_models(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of bodies that are one object and start where it stands. ``tasks``: as written, without copies."""
    first: dict[str, str] = {}
    for task in tasks.values():
        for name, body in _bodies(task):
            if name in first:
                text = f"'{first[name]}' and '{body}' are both '{name}', at one place: each moves a copy of it"
                help = "leave one of the two out, or give it an object of its own, `twin: {use: NAME, position: ...}`"
                found.warning("two-models", text, task.span, help=help.replace("NAME", name))
            first.setdefault(name, body)


def _bodies(task: Task) -> Iterator[tuple[str, str]]:
    """(object, model or body) of what starts where its object stands."""
    if not isinstance(task.kind, Model):
        return
    driven = task.kind.drives()
    several = getattr(task.kind, "bodies", None) or {}
    for name, one in several.items():
        if one.of is not None and one.of.name in driven and one.position is None:
            yield one.of.name, f"{task.name}.{name}"
    if not several and getattr(task.kind, "position", None) is None:
        yield from ((name, task.name) for name in driven)
