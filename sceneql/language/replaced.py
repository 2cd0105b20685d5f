"""Variants that replace more than they mean: all of a section or part, for the sake of one field."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from typing import Final, Literal

from sceneql.language.patch import Patch, variant
from sceneql.language.reuse import USE
from sceneql.language.tree import Mapping, Node, Scalar, unsure
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError

_WORD: Final = re.compile(r"[^\W\d]\w*")
MOST_NAMED: Final = 6
"""Largest number of lost parts that are named."""


def word_of(part: Node | None) -> str:
    """The word of a part as written; empty where it has none or several."""
    if isinstance(part, Scalar):
        return part.text if part.kind == "text" else ""
    words = [key for key in part.entries if key != "repeat"] if isinstance(part, Mapping) else []
    return words[0] if len(words) == 1 and words[0] != USE else ""


def report_replaced(root: Mapping, name: str, families: Collection[str], found: Diagnostics) -> None:
    """Warn of sections that a variant replaces by fewer parts, and report fields that stand in place of a part's word.

    As many parts by other names, a part as it was, which is to stay, and a list, which has no names, replace a section
    without a warning: all of it is meant. Of `define` a name that is lost is an error where it is used still.
    """
    try:
        patches = variant(root, name)
    except ScriptError:
        return
    for patch in patches:
        path, value, span = patch
        for part, was, now in _parts(root, patch, families):
            own = word_of(was)
            fields = [key for key in now.entries if key != "repeat"]
            if own and len(fields) > 1 and own not in fields and USE not in fields:
                text = f"'{name}' puts this in place of all of '{part}', and its word, '{own}', is not there"
                found.error("entry-shape", text, now.span, help=f"write `{name}: {{{dotted(part, now)}}}`")
        old = root.entries.get(path)
        named = path in (*families, "define", "parts")
        if named and isinstance(old, Mapping) and isinstance(value, Mapping) and value.entries and not unsure(value):
            gone = [part for part in old.entries if part not in value.entries]
            kept = [part for part, was in old.entries.items() if part not in gone and _same(was, value.entries[part])]
            if path == "define":
                used = {word for one in _remaining(root, patches) for word in _WORD.findall(one)}
                gone = [part for part in gone if part in used]
            if gone and (path == "define" or (len(value.entries) < len(old.entries) and not kept)):
                told = ", ".join(
                    _changed(path, part, old.entries.get(part), one) for part, one in value.entries.items()
                )
                text = f"'{name}' puts this in place of all of `{path}`, so that {_listed(gone)} not there"
                help = f"what changes alone is named by its path: write `{name}: {{{told}}}`"
                severity: Literal["error", "warning"] = "error" if path == "define" else "warning"
                found.add(Diagnostic("replaces-section", text, span, help, severity=severity))


def _parts(root: Mapping, patch: Patch, families: Collection[str]) -> Iterator[tuple[str, Node, Mapping]]:
    """The parts that a patch replaces as a whole by fields or another word: name, old and new entry."""
    path, value, _ = patch
    section, _, inside = path.rpartition(".")
    for family in families:
        table = root.entries.get(family)
        if not isinstance(table, Mapping):
            continue
        given = dict(value.entries) if path == family and isinstance(value, Mapping) else {}
        if section in ("", family) and inside in table.entries:
            given = {inside: value}
        for part, now in given.items():
            if part in table.entries and isinstance(now, Mapping):
                yield part, table.entries[part], now


def dotted(part: str, fields: Mapping) -> str:
    """The fields of a part by their paths: ``ball.radius: 1 m, ball.color: red``."""
    return ", ".join(f"{part}.{name}: {_short(one)}" for name, one in fields.entries.items() if name != "repeat")


def _remaining(root: Mapping, patches: Sequence[Patch]) -> Iterator[str]:
    """The texts of a script that a variant leaves, and of what it gives."""
    whole = {path for path, _, _ in patches}
    for name, node in root.entries.items():
        if name not in ("variants", *whole):
            yield from _texts(node)
    for _, value, _ in patches:
        yield from _texts(value)


def _texts(node: Node) -> Iterator[str]:
    if isinstance(node, Scalar):
        yield node.text
    for inner in node.entries.values() if isinstance(node, Mapping) else getattr(node, "items", ()):
        yield from _texts(inner)


def _same(node: Node, other: Node) -> bool:
    """Whether two nodes are written alike, but for spaces."""
    return node.span.text.split() == other.span.text.split()


def _changed(section: str, part: str, was: Node | None, now: Node) -> str:
    """What a variant gives a part of a section, by its path: the fields of the same word, else the whole part."""
    word, own = word_of(now), word_of(was)
    if isinstance(now, Mapping) and own:
        if own not in now.entries and not word_of(now):
            return dotted(part, now)
        inner = now.entries.get(own)
        if word == own and isinstance(inner, Mapping) and inner.entries:
            return dotted(part, inner)
    return f"{section}.{part}: {_short(now)}"


def _short(node: Node) -> str:
    text = node.span.text
    return text if "\n" not in text and len(text) <= 60 else "..."


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(f"'{one}'" for one in names[:MOST_NAMED]) + (", ..." if len(names) > MOST_NAMED else "")
    return f"{shown} {'is' if len(names) == 1 else 'are'}"
