"""The tree a script becomes: scalars, lists and mappings, each with its span. Nothing is converted here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from sceneql.quantities.span import Source, Span


@dataclass(slots=True, eq=False)
class Scalar:
    """A scalar as written. ``kind`` is the YAML 1.2 core type of a plain one; a quoted one is always `text`."""

    text: str
    kind: Literal["null", "boolean", "integer", "number", "text"]
    quoted: bool
    source: Source
    start: int
    end: int

    @property
    def span(self) -> Span:
        """The characters of the scalar, quotes included."""
        return Span(self.source, self.start, self.end)

    @property
    def content(self) -> Span:
        """The characters inside the quotes (of a plain scalar: all)."""
        inset = 1 if self.quoted and self.end - self.start >= 2 else 0
        return Span(self.source, self.start + inset, self.end - inset)


@dataclass(slots=True, eq=False)
class Sequence:
    """A list."""

    items: list[Node]
    flow: bool
    source: Source
    start: int
    end: int

    @property
    def span(self) -> Span:
        """From the first to the last character."""
        return Span(self.source, self.start, self.end)


@dataclass(slots=True, eq=False)
class Mapping:
    """Key-value pairs in the order written; ``keys`` holds each key's own node for its span."""

    entries: dict[str, Node]
    keys: dict[str, Scalar]
    flow: bool
    source: Source
    start: int
    end: int

    @property
    def span(self) -> Span:
        """From the first to the last character."""
        return Span(self.source, self.start, self.end)


Node = Scalar | Sequence | Mapping


def written(node: Node) -> Any:
    """A node as plain nested dicts, lists and texts."""
    if isinstance(node, Mapping):
        return {key: written(item) for key, item in node.entries.items()}
    if isinstance(node, Sequence):
        return [written(item) for item in node.items]
    return node.text
