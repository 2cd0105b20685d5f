"""Checks of insides: objects are made of others that have one, and of what is filled or hit no mesh has holes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress

from sceneql.failure import LimitRefused
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Model, Object
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span

CLOSING = "what closes a hole is guessed from its edge: where it is wide, close it in the mesh"
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


def warn_of_open_meshes(tasks: Mapping[str, Task], groups: Iterable[Island], found: Diagnostics) -> None:
    """Warn of each object with holes whose inside is needed, at the first place that needs it."""
    told: set[str] = set()
    for user, name, span in _asked(tasks, groups):
        kind = tasks[name].kind
        if name in told or not isinstance(kind, Object):
            continue
        told.add(name)
        with suppress(TypeError, ValueError, LimitRefused):  # the run reports it
            holes = kind.holes()
            if holes:
                message = f"'{user}' asks for the inside of '{name}', which is open: it has {holes}"
                found.warning("open-mesh", message, span, help=CLOSING)


def _asked(tasks: Mapping[str, Task], groups: Iterable[Island]) -> Iterator[tuple[str, str, Span | None]]:
    """(user, object, span) of each part that needs an object's inside."""
    for task in tasks.values():
        for ref in task.kind.insides() if isinstance(task.kind, Model) else ():
            yield task.name, ref.name, ref.span
    for group in groups:
        for contact, _, others in group.contacts:
            kind = tasks[contact].kind
            written = {ref.name: ref.span for ref in kind.ties()} if isinstance(kind, Contact) else {}
            for other in others:
                yield contact, other, written.get(other, tasks[contact].span)
