"""Help for entries of a list that stand under names, and for named ones that stand in a list."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler.annotations import first_field
from sceneql.language.dashed import without_dashes
from sceneql.language.one_line import one_line
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence
from sceneql.quantities.diagnostic import same_as
from sceneql.quantities.instead import instead

EQUATION = re.compile(r"(?:d\(?(\w+)\)?/dt|(\w+'')|(\w+)'|(\w+)_dot)\s*=\s*(.+)")
LETTERS = "abcdefghijklmnopqrstuvwxyz"
_WORD = re.compile(r"[^\W\d][\w.]*")
_JOINED = re.compile(rf"{_WORD.pattern}(?:\s*[-+&|*,]\s*{_WORD.pattern})+")
SEVERAL, SHOWN = 2, 200
"""Least number of fields that tell that a name is missing, and the longest text that a message repeats."""
NAMES = ("name", "id")
"""Fields by which other programs name the items of a list."""


def listed(node: MappingNode, item: Any, what: str) -> str | None:
    """The help where the items of a list of records stand under names."""
    if not (isinstance(item, type) and issubclass(item, BaseModel)) or not node.entries:
        return None
    known = [kinds.written_name(name) for name in item.model_fields]
    inner = [one for one in node.entries.values() if isinstance(one, MappingNode)]
    if len(inner) < len(node.entries) or not all(_ours(key, known) for one in inner for key in one.entries):
        return None
    if node.entries.keys() & set(known):
        return None
    named, of = "name" in known, dict(zip(node.entries, inner, strict=True))
    items = (f"name: {name}, {_as_ours(one, known)}" if named else _as_ours(one, known) for name, one in of.items())
    return f"it is a list: write `{what}: [{', '.join(f'{{{one}}}' for one in items)}]`"


def _ours(key: str, known: Collection[str]) -> str | None:
    """The field that a key is, by another name too."""
    return key if key in known else same_as(key, known)


def _as_ours(node: MappingNode, known: Collection[str]) -> str:
    """The fields of an item by their names here; what is one here, as two ends, in a list."""
    told: dict[str, list[str]] = {}
    for key, value in node.entries.items():
        told.setdefault(_ours(key, known) or key, []).append(value.span.text)
    texts = {key: f"[{', '.join(each)}]" if len(each) > 1 else each[0] for key, each in told.items()}
    return ", ".join(f"{key}: {text}" for key, text in texts.items())


def by_name(node: Node, item: Any, parts: bool) -> str:
    """The help where records that stand under names are a list, or are named without fields.

    ``parts``: whether the names are those of parts.
    """
    sided = isinstance(item, type) and issubclass(item, BaseModel) and "near" in item.model_fields
    if sided and isinstance(node, Scalar) and (every := instead("bare.boundary", node.text)) is not None:
        return every
    items = node.items if isinstance(node, Sequence) else []
    if (dashed := without_dashes(node)) is not None and not (parts and sided):
        return dashed
    if isinstance(node, Scalar) and _JOINED.fullmatch(node.text.strip()):
        return f"several stand in a list: write `[{', '.join(_WORD.findall(node.text))}]`"
    texts = [one.span.text for one in items or [node]]
    if parts and all(text.isidentifier() for text in texts):
        told = ", ".join(f"{text}: {text.replace('_', ' ')}" for text in texts)
        return f"write `{{{told}}}`, the name of each part before what is told of it"
    if parts and all(part.isidentifier() for text in texts for part in text.split(".")):
        owners = dict.fromkeys(text.partition(".")[0] for text in texts)
        told = ", ".join(f"{text}: {text.replace('_', ' ')}" for text in owners)
        return f"parts are named as a whole, before what is told of each: write `{{{told}}}`"
    record = isinstance(item, type) and issubclass(item, BaseModel)
    texts = [f"{name}: {{{_inside(one, NAMES)}}}" for one in items if (name := _name_in(one))]
    if record and items and len(texts) == len(items):
        return f"write `{{{', '.join(texts)}}}`, the name of each before its fields"
    if record and items and all(isinstance(one, MappingNode) for one in items) and not sided:
        told = ", ".join(f"{name}: {one.span.text}" for name, one in zip(LETTERS, items, strict=False))
        if "\n" not in told and len(items) <= len(LETTERS):
            return f"each has a name of its own: write `{{{told}}}`"
    if not record and (rates := equated([one.span.text for one in items or [node]])) is not None:
        return f"write `{{{rates}}}`"
    if not record and len(items) > 1 and all(isinstance(one, Scalar) for one in items):
        names = [one.span.text.rpartition(".")[2] for one in items]
        own = names if len({*names}) == len(items) and all(map(str.isidentifier, names)) else [*LETTERS]
        told = ", ".join(f"{name}: {one.span.text}" for name, one in zip(own, items, strict=False))
        return f"each has a name of its own: write `{{{told}}}`"
    first = items[0].span.text if items else "name"
    first = first if first.isidentifier() else "name"
    example = first_field(item) if record else "..."
    if not record and not items and isinstance(node, Scalar) and "." in node.text:
        first, example = node.text.rpartition(".")[2], node.text
    if record and "of" in item.model_fields and first != "name":
        example = f"{{of: {first}}}"
    return f"write `{{{first}: {example}}}`, each entry under a name of its own"


def nameless(node: MappingNode, item: Any, what: str) -> str | None:
    """The help for the fields of one record where records stand by names: ``expect: {of: ..., value: 1}``."""
    if not (isinstance(item, type) and issubclass(item, BaseModel)):
        return None
    known = [kinds.written_name(name) for name in item.model_fields]
    inner = [one for one in node.entries.values() if isinstance(one, MappingNode)]
    alone = len(node.entries) < SEVERAL and not all(isinstance(one, Scalar) for one in node.entries.values())
    if alone or not node.entries or not {*node.entries} <= {*known}:
        return None
    if any(key in known for one in inner for key in one.entries):
        return None
    text = one_line(node)
    return f"write `{what}: {{first: {text if len(text) <= SHOWN else '{...}'}}}`, under any name"


def text_meant(node: Node, what: str) -> str | None:
    """The help for a list or a group of fields in place of a text."""
    if isinstance(node, Sequence) and what == "pins":
        return "a pin is a side or a corner, or the number of a mass: write `pins: [top_left, top_right]`"
    if isinstance(node, Sequence) and what == "between":
        place = f"[{', '.join(one.span.text for one in node.items)}]"
        return (
            f"a spring joins two masses: write `hook: {{position: {place}, fixed: yes}}` in `masses`, and here `hook`"
        )
    if isinstance(node, MappingNode) and what == "pins" and "\n" not in node.span.text:
        return f"a place stands under a name: write `pins: {{edge: {node.span.text}}}`"
    return (
        f'write `{what}: "{node.span.text}"`' if isinstance(node, MappingNode) and "\n" not in node.span.text else None
    )


def equated(texts: Collection[str]) -> str | None:
    """Equations as a book writes them, ``x' = v``, as names with values; None of other texts."""
    pieces = [one.strip() for text in texts for one in re.split(r"[,;]\s+", text.strip("'\"")) if one.strip()]
    found = [EQUATION.fullmatch(one) for one in pieces]
    told = [f"{next(filter(None, one.groups()))}: {one[5]}" for one in found if one is not None]
    return ", ".join(told) if told and len(told) == len(pieces) else None


def _name_in(node: Node) -> str:
    """The name that an item of a list gives itself as other programs do; empty for none."""
    given = [node.entries[key] for key in NAMES if key in node.entries] if isinstance(node, MappingNode) else []
    return given[0].text if given and isinstance(given[0], Scalar) else ""


def _inside(node: Node, without: Collection[str] = ()) -> str:
    fields = node.entries if isinstance(node, MappingNode) else {}
    return ", ".join(f"{name}: {value.span.text}" for name, value in fields.items() if name not in without)
