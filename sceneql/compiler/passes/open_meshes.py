"""Warnings of meshes with holes whose inside is needed (filled, collided with, spread in): the closing is a guess."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress

from sceneql.failure import LimitRefused
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Model, Object
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span

HELP = "what closes a hole is guessed from its edge: where it is wide, close it in the mesh"


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
                found.warning("open-mesh", message, span, help=HELP)


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
