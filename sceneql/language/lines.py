"""Repair of lines that lack a colon or have one too many: they are left out, and everything around them is read.

A second colon directly behind a key (``name::``) leaves no line out: `doubled` reads the key without it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

import yaml

from sceneql.language.broken_values import Fault
from sceneql.language.repeat import numbered
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, hole
from sceneql.quantities.diagnostic import Diagnostic, Note
from sceneql.quantities.instead import instead
from sceneql.quantities.span import Source, Span

_HEAD = re.compile(r"[ ]*(?:- +)*")
_HEAD_KEY = re.compile(r"(?:forces|contacts):\s*$")
_NAME: Final = r"[^\s:#\[\]{},\"']+"
_NO_SPACE = re.compile(rf"({_NAME}):(?=[\[{{])")
_NO_COLON = re.compile(rf"({_NAME})[ ]*(?=[\[{{])")
_GLUED = re.compile(r"([\w.'-]+):(?=\S)")
_COMMENT: Final = "a comment begins with `#`: write `#{}`"
COMMENT: Final = re.compile(r"//|--+(?=\s)|/\*|%+(?=\s|$)|;+(?=\s|$)|(?i:rem)(?=\s)")
"""Beginnings of comments of other languages."""
_ASSIGNED = re.compile(r"(?:let |var |const |float |int |double |auto )?\s*([^\W\d]\w*)\s*=\s*([^={;]+);?\s*")
_COLON = re.compile(r":(?=\s|\Z)")
_ROUND = re.compile(r"\(([^()]*(?:\([^()]*\)[^()]*)*)\)")
"""What stands in parentheses as a whole."""


def left_out(source: Source, text: str, error: yaml.YAMLError) -> Fault | None:
    """The text to leave out where YAML fails outside brackets; None where no single line's colon is the cause.

    ``text`` is the source's text with known faults blanked out.
    """
    problem = str(getattr(error, "problem", None) or "").replace("'", "")
    mark = getattr(error, "context_mark" if "could not find expected :" in problem else "problem_mark", None)
    if mark is None or not 0 <= mark.index <= len(text):
        return None
    number = source.position(mark.index)[0]
    line = source.line(number)
    if "expected key" in problem or "<block end>" in problem:
        return _bracketed(source, number, line) or _ended(source, number)
    if "could not find expected :" in problem:
        return _without(source, number)
    if "mapping values are not allowed" in problem:
        if (bracketed := _bracketed(source, number, line)) is not None:
            return bracketed
        before = line[: mark.index - source.line_starts[number - 1]]
        if (first := _COLON.search(before)) is not None:
            return _second(source, number, first.end(), mark.index)
        top = _top(source, number)
        return None if top == number else _without(source, top)
    return None


def unparted(key: Scalar) -> Fault | None:
    """The text to leave out where YAML takes ``name {a: 1}`` up to the colon inside the brackets for a key."""
    if numbered(key.text) is not None:
        return None
    number, column = key.source.position(key.start)
    line = key.source.line(number)
    return _bracketed(key.source, number, line) if column == _head(line) + 1 else None


def doubled(key: Scalar) -> tuple[Scalar, Diagnostic]:
    """A key that ends with a second colon (``name::``) without it, and the diagnostic for it."""
    text = key.text.rstrip(":")
    end = key.start + len(text)
    help = f"write `{text}:`; a name that holds a colon goes in quotes"
    diagnostic = Diagnostic("yaml-syntax", f"a second colon behind '{text}'", Span(key.source, end, key.end), help)
    return Scalar(text, key.kind, False, key.source, key.start, end), diagnostic


def twice(key: Scalar, first: Scalar, *, section: bool) -> Diagnostic:
    """The diagnostic of a key that its mapping holds already, as ``first``; ``section``: at the left margin."""
    help = f"write `{key.text}:` once, and below it what stands below both"
    help = help if section else "remove one of the two, or give it another name"
    note = Note("it stands here first", first.span)
    return Diagnostic("duplicate-key", f"the key '{key.text}' is given twice", key.span, help, (note,))


def marked(anchor: str, source: Source, faults: Iterable[Fault]) -> bool:
    """Whether an anchor is defined in left-out text, so that its alias is no error of its own."""
    mark = re.compile(rf"&{re.escape(anchor)}(?![^\s,\[\]{{}}])")
    return any(mark.search(source.text, fault.start, fault.end) is not None for fault in faults)


def _ended(source: Source, number: int) -> Fault | None:
    """The fault of the line above ``number``, if that is a text without a colon that ends in a comment; else None."""
    above = number - 1
    while above > 0 and _bare(source.line(above)):
        above -= 1
    line = source.line(above) if above > 0 else ""
    if " #" not in line or _COLON.search(line.split(" #")[0]) is not None:
        return None
    top = above - 1
    while top > 0 and _bare(source.line(top)):
        top -= 1
    opening = source.line(top).split(" #")[0].rstrip() if top > 0 else ":"
    # Otherwise the line may continue the value of the key above it.
    return _without(source, above) if opening.endswith(":") or _head(opening) >= _head(line) else None


def _bare(line: str) -> bool:
    """Whether a line is blank or only a comment."""
    return not line.strip() or line.lstrip().startswith("#")


def _bracketed(source: Source, number: int, line: str) -> Fault | None:
    """The fault of a line such as ``name:{`` or ``name {``."""
    head = _head(line)
    if (glued := _NO_SPACE.match(line, head)) is not None:
        message, help = "a space is missing behind this colon", f"write `{glued[1]}: {line[glued.end() :].rstrip()}`"
        return _line(source, number, head, glued.end() - 1, glued.end(), message, help)
    if (bare := _NO_COLON.match(line, head)) is not None:
        message, help = f"a colon is missing behind '{bare[1]}'", f"write `{bare[1]}: {line[bare.end() :].rstrip()}`"
        return _line(source, number, head, *bare.span(1), message, help)
    return None


def _without(source: Source, number: int) -> Fault:
    """The fault of a line of text without a colon: a key that lacks it."""
    line = source.line(number)
    head = _head(line)
    if (glued := _GLUED.match(line, head)) is not None:
        message, help = "a space is missing behind this colon", f"write `{glued[1]}: {line[glued.end() :].strip()}`"
        return _line(source, number, head, glued.end() - 1, glued.end(), message, help)
    written = line[head:].split(" #")[0].rstrip()
    name, _, rest = written.partition(" ")
    rest = rest.strip().removeprefix("=")
    if (sign := COMMENT.match(written)) is not None:
        help = _COMMENT.format(written[sign.end() :].removesuffix("*/").rstrip())
        return _line(source, number, head, head, head + len(written), "a line that is no key", help)
    if head == 0 and (other := _of_code(name, written)) is not None:
        return _line(source, number, head, head, head + len(written), "a line that is no key", other)
    help = f"write `{name}: {rest.strip()}`" if rest else f"write `{name}:` with what belongs to it below, indented"
    bare = not rest and head and not line[:head].strip() and not _holds(source, number)
    if bare and _HEAD_KEY.match(source.line(_margin(source, number))):
        help = f"a word without fields has a name before it: write `{name}: {name}`; or {help.removeprefix('write ')}"
    return _line(source, number, head, head, head + len(written), "a key without a colon", help)


def _of_code(name: str, written: str) -> str | None:
    """The help for a line of a program at the left margin: ``import numpy as np``, ``let r = 2``, ``r = 2``."""
    value = _ASSIGNED.fullmatch(COMMENT.split(written)[0].rstrip())
    if value is not None:
        return f"values have names under `define`: write `define: {{{value[1]}: {value[2].strip()}}}`"
    return instead("section", name.partition("(")[0])


def no_script(text: str) -> str:
    """The help for a text that is no mapping: lines of a program, XML, or another list or value."""
    if text.startswith("<"):
        return "it is YAML, and no XML: write `objects: {ball: {sphere: {radius: 0.1 m}}}`: `sceneql words sections`"
    line = text.partition("\n")[0].strip()
    return _of_code(line.partition(" ")[0], line) or "write `objects:` and the objects below it, indented"


def _second(source: Source, number: int, after: int, colon: int) -> Fault:
    """The fault of a value that holds a second colon."""
    line = source.line(number)
    start = after + len(line[after:]) - len(line[after:].lstrip())
    message = "a second colon on this line, where no key can stand"
    written = line[start:].rstrip()
    round = _ROUND.fullmatch(written)
    help = f"fields on one line have brackets, `{{{written}}}`; a text that holds a colon goes in quotes"
    help = help if round is None else f"fields stand in braces, not in parentheses: write `{{{round[1]}}}`"
    at = colon - source.line_starts[number - 1]
    return _line(source, number, start, at, at + 1, message, help)


def _line(source: Source, number: int, start: int, caret: int, end: int, message: str, help: str) -> Fault:
    """The fault from column ``start`` to the end of the lines indented below; its caret covers ``caret`` to ``end``.

    A fault that begins its line is read as spaces, not as a word, and its mapping becomes partial (`lacking`).
    """
    base = source.line_starts[number - 1]
    line = source.line(number)
    head = _head(line)
    last = number
    for below in range(number + 1, len(source.line_starts) + 1):
        other = source.line(below)
        indent = len(other) - len(other.lstrip(" "))
        if other.strip() and not (indent > head or (indent == head and other[indent:].startswith("- "))):
            break
        if other.strip():
            last = below
    stop = source.line_starts[last - 1] + len(source.line(last).rstrip())
    diagnostic = Diagnostic("yaml-syntax", message, Span(source, base + caret, base + end), help)
    return Fault("yaml-syntax", base + start, stop, base + caret, "", diagnostic, " " if start == head else "x")


def _holds(source: Source, number: int) -> bool:
    """Whether the next line that is not blank is indented deeper than line ``number``."""
    below = next((n for n in range(number + 1, len(source.line_starts) + 1) if not _bare(source.line(n))), number)
    return _head(source.line(below)) > _head(source.line(number))


def _margin(source: Source, number: int) -> int:
    """The line of the section, or of the last key at the left margin, that a line stands below."""
    while number > 1 and (_bare(source.line(number)) or source.line(number)[:1].isspace()):
        number -= 1
    return number


def _top(source: Source, number: int) -> int:
    """The first line of the plain scalar that YAML reads up to the key of line ``number``, of lines without a colon."""
    line = source.line(number - 1) if number > 1 else ""
    while number > 1 and line.strip() and not line.lstrip().startswith("#") and _COLON.search(line) is None:
        number -= 1
        line = source.line(number - 1) if number > 1 else ""
    return number


def _head(line: str) -> int:
    found = _HEAD.match(line)
    return 0 if found is None else found.end()


def lacking(root: Node | None, faults: list[Fault]) -> None:
    """Mark mappings that lack the entry of a left-out line as partial, so that no missing field is reported there.

    A key or list item that consisted of that line alone becomes a hole.
    """
    for fault in faults:
        if fault.blank != " " or root is None or fault.diagnostic is None:
            continue
        here: Node | None = root
        column = root.source.position(fault.start)[1]
        while here is not None and not isinstance(here, Scalar):
            if isinstance(here, Mapping):
                here.partial = True
                before = [name for name, key in here.keys.items() if key.start < fault.start]
                if not before or any(_column(key) == column for key in here.keys.values()):
                    break
                inner = here.entries[before[-1]]
                if _empty(inner):
                    here.entries[before[-1]] = hole(inner.span)
            else:
                if not here.items:
                    break
                at = _item(here, fault)
                inner = here.items[at]
                if _empty(inner):
                    here.items[at] = hole(inner.span)
            here = inner


def _item(list_: Sequence, fault: Fault) -> int:
    """Index of the list item that a left-out line belongs to: the item around it, or the one that it began."""
    source = list_.source
    line, _ = source.position(fault.start)
    behind = next((number for number, item in enumerate(list_.items) if item.start > fault.start), len(list_.items))
    begins = source.line(line).lstrip().startswith("- ")
    if begins and behind > 0 and source.position(list_.items[behind - 1].start)[0] == line:  # the item is there, empty
        begins = False
    return min(max(behind if begins else behind - 1, 0), len(list_.items) - 1)


def _column(node: Node) -> int:
    return node.source.position(node.start)[1]


def _empty(node: Node) -> bool:
    return isinstance(node, Scalar) and node.kind == "null" and not node.text
