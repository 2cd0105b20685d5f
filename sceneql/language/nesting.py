"""Un-nesting of children that are written in place under names: they become parts of their section.

``hip: {group: {children: {knee: {sphere: {}}}}}`` means ``hip: {group: {children: {knee: knee}}}`` and ``knee: {sphere:
{}}``. Where `repeat` stands beside one of them, the children stay in place: each copy has its own.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from sceneql.language.sections import duplicate
from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.quantities.diagnostic import Diagnostics

CHILDREN: Final = "children"


def unnested(root: Mapping, families: Collection[str], found: Diagnostics) -> Mapping:
    """The script with nested children moved behind their parents, as entries of its or its templates' sections."""
    result = _unnested(root, families, found)
    templates = root.entries.get("templates")
    if isinstance(templates, Mapping):
        bodies = {
            name: _unnested(body, families, found) if isinstance(body, Mapping) else body
            for name, body in templates.entries.items()
        }
        result.entries["templates"] = _like(templates, bodies)
    return result


def _unnested(body: Mapping, families: Collection[str], found: Diagnostics) -> Mapping:
    return _like(
        body,
        {
            key: _flat(node, found) if key in families and isinstance(node, Mapping) else node
            for key, node in body.entries.items()
        },
    )


def _flat(section: Mapping, found: Diagnostics) -> Mapping:
    result = section.holding({}, {})
    todo = [(name, section.keys[name], node) for name, node in reversed(section.entries.items())]
    while todo:
        name, key, node = todo.pop()
        if name in result.entries:
            duplicate(name, result.keys[name], key, found)
            continue
        node, children = _parted(node)
        result.entries[name], result.keys[name] = node, key
        todo += reversed(children)
    return result


def _parted(node: Node) -> tuple[Node, list[tuple[str, Scalar, Node]]]:
    """An entry with its children replaced by their names, and the children as (name, key, node)."""
    if not isinstance(node, Mapping) or len(node.entries) != 1:
        return node, []
    ((word, fields),) = node.entries.items()
    table = fields.entries.get(CHILDREN) if isinstance(fields, Mapping) else None
    if not isinstance(fields, Mapping) or not isinstance(table, Mapping):
        return node, []
    children: list[tuple[str, Scalar, Node]] = [
        (name, table.keys[name], item)
        for name, item in table.entries.items()
        if isinstance(item, Mapping) and "repeat" not in item.entries
    ]
    names: dict[str, Node] = {
        name: Scalar(name, "text", False, key.source, key.start, key.end) for name, key, _ in children
    }
    inner = _like(fields, {**fields.entries, CHILDREN: _like(table, {**table.entries, **names})})
    return _like(node, {word: inner}), children


def _like(mapping: Mapping, entries: dict[str, Node]) -> Mapping:
    """A copy of a mapping with other values under the same keys."""
    return mapping.holding(entries)
