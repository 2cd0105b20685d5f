"""Doubtful settings: what a word finds in its own fields, told as warnings."""

from __future__ import annotations

from dataclasses import dataclass

from sceneql.quantities.span import Span


@dataclass(frozen=True, slots=True)
class Doubt:
    """A likely mistake: something that a run will do and that may not be meant."""

    code: str
    text: str
    place: Span | None
    help: str
