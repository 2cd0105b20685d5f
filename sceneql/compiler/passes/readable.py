"""Check of values in solved systems: they may not read outputs that are computed from the state, as energies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any

from pydantic import BaseModel

from sceneql.compiler.values_below import values_of
from sceneql.graph import Island, Task
from sceneql.kinds import Model, Paint, Quantity, Value, grammar_of
from sceneql.kinds.values import unreadable
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.expression import Link
from sceneql.quantities.span import Span


def report_unreadable(tasks: Mapping[str, Task], groups: Iterable[Island], found: Diagnostics) -> None:
    """Report values of an island's parts that read computed outputs of its models; colors may.

    Outputs that are part of the state only in some scenes, as the center of a single mass, are left to the run.
    """
    for island in groups:
        acting = (*(name for name, _ in island.forces), *(name for name, _, _ in island.contacts))
        told: set[Span | None] = set()
        for part in dict.fromkeys((*island.models, *acting)):
            links = (link for value in _solved_values(tasks[part].kind) for link in _read(value, tasks))
            for link in links:
                if link.computed and link.task in island.models and link.span not in told:
                    told.add(link.span)
                    found.add(unreadable(link, tasks[part].span))


def _solved_values(part: Any) -> Iterator[Value]:
    """The values in a kind, record, list or dict at any depth, without colors."""
    if isinstance(part, BaseModel):
        for name, info in type(part).model_fields.items():
            mark = grammar_of(info)[0]
            of_cells = isinstance(mark, Quantity) and mark.shape == (None,) and mark.dimension is None
            if not isinstance(mark, Paint) and not of_cells:  # values by cell are checked by the part itself
                yield from _solved_values(getattr(part, name))
    elif isinstance(part, dict):
        for item in part.values():
            yield from _solved_values(item)
    elif isinstance(part, list | tuple):
        for item in part:
            yield from _solved_values(item)
    else:
        yield from values_of(part)


def _read(value: Value, tasks: Mapping[str, Task]) -> Iterator[Link]:
    """The outputs that a value reads, including those read by formulas behind these."""
    stack, known = list(value.links), set[Link]()
    while stack:
        link = stack.pop()
        if link in known:
            continue
        known.add(link)
        yield link
        kind = tasks[link.task].kind
        if isinstance(kind, Model):
            with suppress(ScriptError):  # a velocity; the run reports it
                stack += Value(kind.formula(link.output)).links if kind.kinematic else ()
        elif isinstance(made := getattr(kind, link.output, None), Value):
            stack += made.links
