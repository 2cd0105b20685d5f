"""Warnings of solids and surfaces that were empty in every picture of a film."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from sceneql.kinds import Object
from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Shape
    from sceneql.graph import Task

NO_SHAPE = "it was empty whenever it was drawn"
LITTLE = 0.01
"""Fraction of a solid's bounds in which rounding may decide the sign of its field without a warning."""


def solids(names: Iterable[str], tasks: Mapping[str, Task]) -> Iterator[str]:
    """Names of the solids among parts and their members: those drawn by implicit fields, or by triangles of these."""
    for name in names:
        kind = tasks[name].kind
        if not isinstance(kind, Object):
            continue
        if kind.traced or kind.unseen:
            yield name
        else:
            yield from solids((ref.name for ref in kind.members() if not _hidden(tasks[ref.name])), tasks)


def _hidden(task: Task) -> bool:
    return isinstance(task.kind, Object) and task.kind.hidden


def look(shapes: Sequence[Shape], asked: Iterable[str], tasks: Mapping[str, Task], present: dict[str, str]) -> None:
    """Record in ``present``, by name, why nothing of a solid was drawn, or "" once something may have been.

    ``asked``: the solids (by ``solids``) that the shapes were made of.
    """
    from sceneql.frame import Implicit

    shown = {shape.name for shape in shapes}
    for name in asked:
        if name not in shown:
            kind = tasks[name].kind
            present.setdefault(name, (isinstance(kind, Object) and kind.unseen) or NO_SHAPE)
    for shape in shapes:
        if not isinstance(shape, Implicit):
            if shape.name in present:
                present[shape.name] = ""
        elif present.get(shape.name, "new"):
            from sceneql.field.tape.emptiness import nowhere_finite, proved_rootless, why_empty

            bounded = shape.tape, shape.low, shape.high
            if shape.within is None:
                found = why_empty(*bounded)
            else:
                found = "nowhere zero" if proved_rootless(*bounded) else ""
            if not found and nowhere_finite(*bounded):
                found = "nowhere finite"
            present[shape.name] = found and f"its field is {found} in its bounds"


def look_at_rounding(shapes: Sequence[Shape], rounded: dict[str, float]) -> None:
    """Record in ``rounded``, by name, the fraction of an implicit solid's bounds in which rounding decides its sign."""
    from sceneql.frame import Implicit

    for shape in shapes:
        if isinstance(shape, Implicit) and shape.name not in rounded:
            from sceneql.field.tape.emptiness import blurred

            rounded[shape.name] = blurred(shape.tape, shape.low, shape.high)


def decided_by_rounding(rounded: Mapping[str, float], tasks: Mapping[str, Task]) -> Iterator[Diagnostic]:
    """A warning for each solid with more than LITTLE of such bounds, at its formula where it has one."""
    for name, share in rounded.items():
        if share > LITTLE:
            formula = getattr(tasks[name].kind, "field", None)
            yield Diagnostic(
                "rounding",
                f"rounding decides what is inside '{name}' in {100 * share:.0f} % of its bounds; pixels are undecided",
                getattr(formula, "span", None) or tasks[name].span,
                help="of large terms that cancel, rounding alone is left: write the formula without them",
                severity="warning",
            )


def missing(present: Mapping[str, str], tasks: Mapping[str, Task]) -> tuple[Diagnostic, ...]:
    """A warning for each solid of which nothing was drawn at any moment."""
    return tuple(
        Diagnostic("empty-solid", f"nothing of '{name}' was ever there: {why}", tasks[name].span, severity="warning")
        for name, why in present.items()
        if why
    )
