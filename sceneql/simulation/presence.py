"""Which solids and surfaces of a film had anything to draw, so that the film says what it never showed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Shape
    from sceneql.graph import Task


def look(shapes: Iterable[Shape], present: dict[str, str]) -> None:
    """Note of each implicit shape by name why its box holds nothing of it, or nothing where it may, now or before."""
    from sceneql.frame import Implicit

    for shape in shapes:
        if isinstance(shape, Implicit) and present.get(shape.name, "new"):
            from sceneql.field.emptiness import nowhere_finite, proved_empty, proved_rootless

            proved, found = (proved_empty, "negative") if shape.within is None else (proved_rootless, "zero")
            if not proved(shape.tape, shape.low, shape.high):
                found = "finite" if nowhere_finite(shape.tape, shape.low, shape.high) else ""
            present[shape.name] = found


def missing(present: Mapping[str, str], tasks: Mapping[str, Task]) -> tuple[Diagnostic, ...]:
    """A warning for each shape that was proved empty at every moment."""
    return tuple(
        Diagnostic(
            "empty-solid",
            f"nothing of '{name}' was ever there: its field is nowhere {found} in its bounds",
            tasks[name].span,
            severity="warning",
        )
        for name, found in present.items()
        if found
    )
