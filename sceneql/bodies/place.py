"""The field `at` of a word: the mass, or the point of a rigid body, on which it acts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sceneql.kinds import Problem, Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Link

if TYPE_CHECKING:
    from sceneql.system import Assembly, Place

HELP = "name a mass, `net.bob`, or a point of a rigid body, `crate.hook`"


def model_of(at: Value) -> tuple[str, ...]:
    """The model that a value links to, as a tuple of one; empty where the value is no link."""
    return (at.expr.task,) if isinstance(at.expr, Link) else ()


def place_problems(at: Value | None, models: bool) -> Iterator[Problem]:
    """Problems: `at` that is no link to a mass; `at` besides `on` (``models``: whether models are named)."""
    if at is not None and not isinstance(at.expr, Link):
        yield Problem(f"this is a place, but no mass to act on: {HELP}", ("at",))
    if at is not None and models:
        yield Problem("what acts `at` a place acts on that alone", ("on",), at_key=True)


def place_of(at: Value, assembly: Assembly) -> Place:
    """The mass or point of a body that a value links to. Raises ScriptError for any other value."""
    place = assembly.place(at.expr) if isinstance(at.expr, Link) else None
    if place is None:
        raise ScriptError([Diagnostic("no-mass", "there is no mass here to act on", at.span, HELP)])
    return place
