"""Check of objects made of the insides of others: each of these must have one."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import Diagnostics

HELP = "primitives, formulas and skeletons have one, and what is joined or warped of them"


def report_hollow(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report objects without an inside of which others are made."""
    for task in tasks.values():
        for ref in task.kind.joins() if isinstance(task.kind, Object) else ():
            hollow = without_inside(tasks[ref.name], tasks)
            if hollow is not None:
                word = type(hollow.kind).__module__.rpartition(".")[2]
                which = f"a {word}" if hollow.name == ref.name else f"{word} '{hollow.name}' in it"
                message = f"'{task.name}' needs the inside of '{ref.name}', but {which} has none"
                found.error("no-inside", message, ref.span, help=HELP)


def without_inside(task: Task, tasks: Mapping[str, Task]) -> Task | None:
    """The first of an object and its members, at any depth, without an implicit field; None where all have one."""
    stack, seen = [task], set[str]()
    while stack:
        one = stack.pop()
        if not isinstance(one.kind, Object) or type(one.kind).implicit is Object.implicit:
            return one
        if one.name not in seen:
            seen.add(one.name)
            stack += [tasks[ref.name] for ref in reversed(one.kind.members())]
    return None
