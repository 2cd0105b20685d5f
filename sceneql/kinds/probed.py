"""Places of which a model tells what it has there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.kinds.values import Ref


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
