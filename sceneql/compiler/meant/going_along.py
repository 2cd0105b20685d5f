"""Help for what goes along with another part, its parent in other programs: a group of both, or a link to its place.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the field.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler.meant.own_values import numbers_with_unit
from sceneql.language.one_line import one_line
from sceneql.language.tree import Mapping, Node, Scalar

PARENTS = ("parent", "parent_to", "attach_to", "attached_to", "child_of")
"""Fields of other programs for the part that another goes along with."""
PLACED = ("position", "rotation")
"""Fields of a part that place it, which go to the group that it stands in."""
GROUP = "rig"
"""Name of a group in examples."""
SHOWN = 300
"""Longest group that a message writes."""


def carried(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for the part that another goes along with: a group where that turns, else a link to its place."""
    other = node.entries[name].span.text
    if name not in PARENTS or "position" not in cls.model_fields or not other.isidentifier():
        return None
    return _turned(reader, cls, other) or _linked(other, node)


def _turned(reader: Any, cls: type[BaseModel], other: str) -> str | None:
    """The help for an object with a rotation, and that no model moves: a group of it and of all that goes along."""
    parts = reader.names.parts
    fields = _fields(parts, other)
    if "rotation" not in fields or not issubclass(cls, kinds.Object) or reader.owner not in parts:
        return None
    if any(_names(value, other) for one in parts if (value := _fields(parts, one).get("of")) is not None):
        return None
    with_it = [one for one in parts if any(_names(value, other) for value in _parents(_fields(parts, one)))]
    placed = {key: fields[key] for key in PLACED if key in fields}
    moved = "".join(f", {key}: {one_line(value)}" for key, value in placed.items())
    group = GROUP if GROUP not in parts else f"{other}_{GROUP}"
    told = f"{group}: {{group: {{children: [{', '.join([other, *with_it])}]{moved}}}}}"
    if len(told) > SHOWN:
        return None
    out = " and ".join(f"`{key}`" for key in placed)
    what = f"what turns along with '{other}' stands with it in a group: write `{told}`"
    return f"{what}, and leave out {out} of '{other}', and this field; the `position` of '{reader.owner}' is from there"


def _linked(other: str, node: Mapping) -> str | None:
    place = node.entries.get("position")
    numbers = None if place is None else numbers_with_unit(place.span.text)
    if place is not None and (numbers is None or len(numbers[0]) != 3):
        return None
    away = "" if numbers is None else f" + [{', '.join(f'{one:g} {numbers[1]}'.rstrip() for one in numbers[0])}]"
    link = f'"{other}.position{away}"' if away else f"{other}.position"
    linked = f"what goes along with '{other}' is linked to its place: write `position: {link}`"
    return f"{linked}; if it is a group this goes to its `children`"


def _fields(parts: Any, name: str) -> dict[str, Node]:
    node = parts[name].fields if name in parts else None
    return node.entries if isinstance(node, Mapping) else {}


def _parents(fields: dict[str, Node]) -> Collection[Node]:
    return [fields[one] for one in PARENTS if one in fields]


def _names(value: Node, other: str) -> bool:
    return isinstance(value, Scalar) and value.text == other
