"""Which solids of a film had anything to draw, so that the film says what it never showed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Shape
    from sceneql.graph import Task


def look(shapes: Iterable[Shape], present: dict[str, bool]) -> None:
    """Note of each implicit solid by name whether it may have anything in its box, now or at a moment before."""
    from sceneql.field.emptiness import proved_empty
    from sceneql.frame import Implicit

    for shape in shapes:
        if isinstance(shape, Implicit) and not present.get(shape.name):
            present[shape.name] = not proved_empty(shape.tape, shape.low, shape.high)


def missing(present: Mapping[str, bool], tasks: Mapping[str, Task]) -> tuple[Diagnostic, ...]:
    """A warning for each solid that was proved empty at every moment."""
    return tuple(
        Diagnostic(
            "empty-solid",
            f"nothing of '{name}' was ever there: its field is nowhere negative in its bounds",
            tasks[name].span,
            severity="warning",
        )
        for name, there in present.items()
        if not there
    )
