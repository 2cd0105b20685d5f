"""Places of which a model tells what it has there, or that it holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.kinds.values import Ref
    from sceneql.quantities.span import Span


@dataclass(frozen=True, slots=True)
class Probed:
    """A place that has to lie inside an object as it is at the start."""

    path: tuple[str, ...]
    """Steps to its field; the last is its name."""
    place: tuple[float, ...]
    """Two or three numbers [m]; two are of the section at z = 0."""
    inside: Ref
    room: float | None
    """How far outside of the object it may lie [m]; None: a tenth of the object's longest side."""


@dataclass(frozen=True, slots=True)
class HeldPart:
    """A part of a solid that is held by its place."""

    name: str
    span: Span | None
    """Where the script says that place."""
    inside: Ref | tuple[Sequence[float], Sequence[float]]
    """The object that the solid fills, or the low and high corner of its own box [m]."""
    misses: Callable[[Sequence[float], Sequence[float]], bool]
    """Whether no place of a box, given by such corners, is held."""
