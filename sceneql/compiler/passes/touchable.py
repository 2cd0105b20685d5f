"""The objects that a contact touches when it names none."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.passes.insides import without_inside
from sceneql.compiler.passes.reads import reads
from sceneql.graph import Task
from sceneql.kinds import Formula, Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics

PLACE = ("position", "rotation")
"""Fields that may vary in time while the shape stays the same."""


def touchable(tasks: Mapping[str, Task], found: Diagnostics | None = None) -> tuple[str, ...]:
    """Names of the objects that a contact touches by default; ``found`` gets a warning for each that is left out.

    They have an inside, and no model drives them. Left out without a warning: members of others, hidden objects that
    models or objects are made of, and objects that have no inside or are drawn where a model is (a trail, the surface
    of a liquid).
    """
    objects = [t for t in tasks.values() if isinstance(t.kind, Object)]
    models = [t for t in tasks.values() if isinstance(t.kind, Model)]
    aside = {name for t in models if isinstance(t.kind, Model) for name in t.kind.drives()}
    aside |= {ref.name for t in objects if isinstance(t.kind, Object) for ref in t.kind.members()}
    material = {name for t in (*models, *objects) for name in t.needs}
    result = []
    for task in objects:
        kind = task.kind
        if task.name in aside or not isinstance(kind, Object) or (kind.hidden and task.name in material):
            continue
        if not _has_surface(kind):
            continue
        followed = reads(task.name, tasks)
        if _changes_shape(task, tasks):
            reason = "" if followed else "it changes its shape in time"
        elif followed:
            reason = f"it follows '{followed[0]}', which is solved"
        elif not _has_inside(task, tasks):
            reason = "a part of it has no inside"
        else:
            result.append(task.name)
            continue
        if found is not None and reason:
            found.warning(
                "not-touched",
                f"contacts leave out '{task.name}': {reason}",
                task.span,
                help="masses pass through it; to say so, name under `between` what collides",
            )
    return tuple(result)


def no_collider(task: Task, tasks: Mapping[str, Task]) -> str | None:
    """The reason why an object that a contact names cannot be collided with, as far as the script tells.

    None where it can.
    """
    if not isinstance(task.kind, Object) or type(task.kind).collider is not Object.collider:
        return None
    hollow = without_inside(task, tasks)
    if hollow is not None:
        return f"`{hollow.word}` has no inside"
    return "a surface that changes its shape in time cannot be collided with" if _changes_shape(task, tasks) else None


def _has_surface(kind: Object) -> bool:
    return type(kind).collider is not Object.collider or type(kind).implicit is not Object.implicit


def _members(task: Task, tasks: Mapping[str, Task]) -> list[Task]:
    assert isinstance(task.kind, Object)
    return [tasks[ref.name] for ref in task.kind.members()]


def _has_inside(task: Task, tasks: Mapping[str, Task]) -> bool:
    """Whether an object has a collider of its own, or it and all of its members have an implicit field."""

    kind = task.kind
    assert isinstance(kind, Object)
    return type(kind).collider is not Object.collider or without_inside(task, tasks) is None


def _changes_shape(task: Task, tasks: Mapping[str, Task]) -> bool:
    """Whether an object changes in time in a way that contacts cannot follow: other than by its placement.

    Never where its word `collides`.
    """

    def varying(one: Task) -> set[str]:
        return {name for name, value in one.kind if isinstance(value, Value | Formula) and not value.constant}

    def moves(one: Task) -> bool:
        return bool(varying(one)) or any(moves(m) for m in _members(one, tasks))

    assert isinstance(task.kind, Object)
    if task.kind.collides:
        return False
    return not varying(task) <= set(PLACE) or any(moves(m) for m in _members(task, tasks))
