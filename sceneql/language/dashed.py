"""Fields and values by name that stand in lists, behind dashes, or as names alone: for messages."""

from __future__ import annotations

import re
from collections.abc import Collection

from sceneql.language.one_line import one_line
from sceneql.language.tree import Mapping, Node, Scalar, Sequence

SHOWN = 200
"""Longest text that a message repeats."""
_SIGN = re.compile(r"[\s,]+")


def undashed(node: Node) -> str | None:
    """The items of a list that each hold one or more names with values, as one mapping: ``{of: ball, mass: 1 kg}``.

    None for other values, and where a name stands in two of them.
    """
    items = node.items if isinstance(node, Sequence) else []
    told: dict[str, str] = {}
    for item in items:
        if not isinstance(item, Mapping) or item.partial or not item.entries or told.keys() & item.entries.keys():
            return None
        told |= {name: one_line(value) for name, value in item.entries.items()}
    text = f"{{{', '.join(f'{name}: {value}' for name, value in told.items())}}}"
    return text if told and "\n" not in text and len(text) <= SHOWN else None


def without_dashes(node: Node, known: Collection[str] | None = None) -> str | None:
    """The help for fields that stand behind dashes, `- of: ball`, where they stand by name.

    ``known``: the names of the fields, one of which has to be among them; None: any names.
    """
    text = undashed(node)
    items = node.items if isinstance(node, Sequence) else []
    if known is not None and not any(name in known for one in items for name in getattr(one, "entries", ())):
        return None
    dashes = isinstance(node, Sequence) and not node.flow
    told = "a dash begins an item of a list, and here stand" if dashes else "a list has no names, and here stand"
    return None if text is None else f"{told} names with values: write `{text}`"


def names_alone(node: Node) -> str | None:
    """Names in a list as fields without values, ``{at: , height: }``; None for other lists."""
    items = node.items if isinstance(node, Sequence) else []
    names = [item.text if isinstance(item, Scalar) else "" for item in items]
    if not names or not all(name.isidentifier() for name in names):
        return None
    return f"{{{', '.join(f'{name}: ' for name in names)}}}"


def words_apart(text: str) -> str:
    """Words of parts with a space, a line or a dash between them, as the items of a list: ``gravity, collision``."""
    text = text.strip("[] ")
    words = [word.removeprefix("-") for word in _SIGN.split(text) if word.strip("-")]
    return ", ".join(words) if all(word.isidentifier() for word in words) else text
