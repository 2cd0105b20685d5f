"""Spans of characters of a scalar's text in the script, which may write them escaped, folded or indented."""

from __future__ import annotations

import re

from sceneql.language.tree import Scalar
from sceneql.quantities.span import Span

ESCAPE = re.compile(r"\\(?:x[0-9a-fA-F]{2}|u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|.)", re.DOTALL)
"""One written character between double quotes."""
SKIPPED = {"'": re.compile(r"\s*"), '"': re.compile(r"(?:\s|\\\r?\n)*")}
"""Text before a character that belongs to no character (line ends and indentation), by the kind of quotes."""
WRITTEN = {"'": re.compile(r"''|.", re.DOTALL), '"': re.compile(rf"{ESCAPE.pattern}|.", re.DOTALL)}
"""One written character, by the kind of quotes."""


def within(node: Scalar, start: int, end: int) -> Span:
    """The span of characters ``start`` to ``end`` of a scalar's text; the whole scalar where they cannot be located."""
    text, quote = node.source.text, node.source.text[node.start : node.start + 1] if node.quoted else ""
    at, last = node.content.start, node.content.end
    if quote in ("|", ">"):
        at, last, quote = text.find("\n", node.start) + 1, node.end, ""
    skipped, written = SKIPPED.get(quote, SKIPPED["'"]), WRITTEN.get(quote)
    places = []
    for one in node.text[:end]:
        if not one.isspace() and (gap := skipped.match(text, at, last)) is not None:
            at = gap.end()
        found = None if written is None else written.match(text, at, last)
        after = at + 1 if found is None else found.end()
        if after > last or (after == at + 1 and text[at] != one and not (one.isspace() and text[at].isspace())):
            return node.span
        places.append((at, after))
        at = after
    return Span(node.source, places[start][0], places[end - 1][1]) if start < end <= len(places) else node.span
