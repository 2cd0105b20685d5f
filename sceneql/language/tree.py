"""The tree of a script: scalars, lists and mappings, each with its span. Nothing is converted here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from sceneql.quantities.span import Source, Span


@dataclass(slots=True, eq=False)
class Scalar:
    """A scalar as written. ``kind``: the YAML 1.2 core type of a plain one; a quoted one is always `text`.

    A `broken` scalar stands for a value reported as unreadable, about which no further error is reported.
    """

    text: str
    kind: Literal["null", "boolean", "integer", "number", "text", "broken"]
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
        """The characters inside the quotes; of a plain scalar, all."""
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
    """Key-value pairs in the order written; ``keys`` holds each key's own node for its span.

    ``partial``: some entries were reported and left out, so that missing ones are no errors. ``index``: of a copy
    inside a part's fields, the name of its number, and the number.
    """

    entries: dict[str, Node]
    keys: dict[str, Scalar]
    flow: bool
    source: Source
    start: int
    end: int
    partial: bool = False
    index: tuple[str, Scalar] | None = None

    @property
    def span(self) -> Span:
        """From the first to the last character."""
        return Span(self.source, self.start, self.end)

    def holding(self, entries: dict[str, Node], keys: dict[str, Scalar] | None = None) -> Mapping:
        """A copy of the mapping with other entries (and other keys)."""
        keys = self.keys if keys is None else keys
        return Mapping(entries, keys, self.flow, self.source, self.start, self.end, self.partial, self.index)


Node = Scalar | Sequence | Mapping


def broken(node: Node) -> bool:
    """Whether the node was reported as unreadable."""
    return isinstance(node, Scalar) and node.kind == "broken"


def unsure(node: Node) -> bool:
    """Whether the node is broken or partial, so that its content is not fully known."""
    return node.partial if isinstance(node, Mapping) else broken(node)


def whole(node: Node) -> bool:
    """Whether neither a node nor any node below it is broken or partial; shared nodes are visited once."""
    seen: set[int] = set()
    stack = [node]
    while stack:
        one = stack.pop()
        if unsure(one):
            return False
        if id(one) not in seen and not isinstance(one, Scalar):
            seen.add(id(one))
            stack += one.items if isinstance(one, Sequence) else one.entries.values()
    return True


def extent(node: Node, known: dict[int, tuple[int, int]]) -> tuple[int, int]:
    """Depth and number of nodes of a finished tree, with shared nodes counted at each place.

    ``known`` caches these of collections, by id.
    """
    if isinstance(node, Scalar):
        return 0, 1
    if id(node) not in known:
        inner = [extent(n, known) for n in (node.items if isinstance(node, Sequence) else node.entries.values())]
        keys = 0 if isinstance(node, Sequence) else len(node.keys)
        known[id(node)] = 1 + max((d for d, _ in inner), default=0), 1 + keys + sum(s for _, s in inner)
    return known[id(node)]


def hole(span: Span) -> Scalar:
    """A `broken` scalar that stands for an unreadable value."""
    return Scalar("", "broken", False, span.source, span.start, span.end)


def written(node: Node) -> Any:
    """A node as plain nested dicts, lists and texts."""
    if isinstance(node, Mapping):
        return {key: written(item) for key, item in node.entries.items()}
    if isinstance(node, Sequence):
        return [written(item) for item in node.items]
    return node.text
