"""Points that a model measures at or holds, which `check` compares with objects."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.kinds.values import Ref
    from sceneql.quantities.span import Span


@dataclass(frozen=True, slots=True)
class Probed:
    """A point that has to lie inside an object as it is at the start."""

    path: tuple[str, ...]
    """Path to the field that gives the point; the last step is the field's name."""
    place: tuple[float, ...]
    """(2,) or (3,) coordinates [m]; two are in the plane z = 0."""
    inside: Ref
    room: float | None
    """Distance outside of the object that is tolerated [m]; None: a tenth of the object's longest side."""


@dataclass(frozen=True, slots=True)
class HeldPart:
    """A part of a solid that is held fixed, selected by position."""

    name: str
    span: Span | None
    """Where the script selects it."""
    inside: Ref | tuple[Sequence[float], Sequence[float]]
    """The object that the solid fills, or the low and high corner of its own box [m]."""
    misses: Callable[[Sequence[float], Sequence[float]], bool]
    """Function of the low and high corner (3,) [m] of a box: whether no point of the box is held."""
