"""An object in a group that scales it, as a message shows it: an object alone has sizes, and no scale."""

from __future__ import annotations

from collections.abc import Mapping as Table
from typing import Final

from sceneql.language.tree import Node

PLACING: Final = ("position", "rotation", "scale")
"""Fields that a group has in place of the object in it."""
SHOWN: Final = 600
"""Longest entry that a message shows as a whole."""


def in_group(word: str, fields: Table[str, Node]) -> str:
    """``{group: {children: [{sphere: {radius: 1 m}}], scale: 1 2 1}}`` for a word with fields, a scale among them."""
    own = ", ".join(f"{name}: {node.span.text}" for name, node in fields.items() if name not in PLACING)
    placed = {name: fields[name].span.text for name in PLACING if name in fields}
    whole = _group(f"{word}: {{{own}}}", placed)
    if len(whole) > SHOWN or "\n" in whole:
        whole = _group(f"{word}: {{...}}", dict.fromkeys(placed, "..."))
    return whole


def _group(child: str, placed: Table[str, str]) -> str:
    more = ", ".join(f"{name}: {text}" for name, text in placed.items())
    return f"{{group: {{children: [{{{child}}}], {more}}}}}"
