"""Entries of a script with the scope in which their names are looked up, as the checker reads them."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Mapping as Table
from dataclasses import dataclass, field

from sceneql.language.tree import Mapping, Node, Sequence
from sceneql.quantities.span import Span


@dataclass(frozen=True, slots=True, eq=False)
class Scope:
    """The meaning of names inside an instance of a template or a copy.

    ``names`` maps local names to those of the whole script (``hip`` to ``front_left.hip``). ``fields`` holds the nodes
    of fields and copy numbers; names in such a node are looked up in ``outer``, so that a field given to an instance
    sees what is outside it, and a default sees the fields before it.
    """

    names: Table[str, str]
    fields: Table[str, Node]
    outer: Scope | None

    def resolve(self, name: str) -> str:
        """The name in the whole script of the local name ``name``; other names stay as they are."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.names:
                return scope.names[name]
            scope = scope.outer
        return name


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One part: its name in the whole script, its word, the node of its fields if any, and where both are written."""

    name: str
    word: str
    fields: Node | None
    span: Span
    word_span: Span
    scope: Scope | None

    def place(self, path: Iterable[str | int]) -> Span | None:
        """The span of a field, by its path; that of the entry where the field is not written."""
        node: Node | None = self.fields
        for step in path:
            if isinstance(node, Mapping) and step in node.entries:
                node = node.entries[step]
            elif isinstance(node, Sequence) and isinstance(step, int):
                node = node.items[step]
            else:
                return self.span
        return None if node is None else node.span


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """The node of a template's output, and the scope of the instance."""

    node: Node
    scope: Scope


class Broken:
    """Names whose definitions were reported as unreadable: errors about these names are not reported."""

    def __init__(self) -> None:
        self.any = False
        """Whether any name at all may be one of them."""
        self._names: set[str] = set()

    def add(self, name: str) -> None:
        """Add a name."""
        self._names.add(name)

    @property
    def names(self) -> tuple[str, ...]:
        """The names themselves."""
        return tuple(self._names)

    def __contains__(self, name: str) -> bool:
        """Whether the name, or a part that would hold it, is one of them: ``leg.knee`` where ``leg`` is."""
        if self.any or name in self._names:
            return True
        return any(name[:at] in self._names for at, character in enumerate(name) if character == ".")


@dataclass(slots=True, eq=False)
class Expanded:
    """Sections without templates or copies.

    ``gives`` holds the outputs of instances (``lantern.0.lit``); ``groups`` the names of all parts that stand for one
    written name (``dust``: ``dust.0``, ``dust.1``, ...; ``front_left``: ``front_left.hip``, ...); ``broken`` the names
    of entries that were reported and left out. ``unmade`` holds the entries of templates without an instance, under
    names that no script can write: they are checked, not built.
    """

    sections: dict[str, dict[str, Entry]] = field(default_factory=dict)
    gives: dict[str, Given] = field(default_factory=dict)
    groups: dict[str, list[str]] = field(default_factory=dict)
    broken: Broken = field(default_factory=lambda: Broken())
    unmade: dict[str, dict[str, Entry]] = field(default_factory=dict)
