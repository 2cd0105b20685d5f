"""Lines in which a colon is missing or one too many: they are left out, and all around them is read."""

from __future__ import annotations

import re
from typing import Final

import yaml

from sceneql.language.torn import Fault
from sceneql.language.tree import Mapping, Node
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.span import Source, Span

_HEAD = re.compile(r"[ ]*(?:- +)*")
_NAME: Final = r"[^\s:#\[\]{},\"']+"
_NO_SPACE = re.compile(rf"({_NAME}):(?=[\[{{])")
_NO_COLON = re.compile(rf"({_NAME})[ ]*(?=[\[{{])")
_COLON = re.compile(r":(?=\s|\Z)")


def left_out(source: Source, text: str, error: yaml.YAMLError) -> Fault | None:
    """What is to be left out where YAML fails outside brackets; None where it is not a matter of one line's colon.

    ``text`` is the source's with what is mended already blanked out.
    """
    problem = str(getattr(error, "problem", None) or "").replace("'", "")
    mark = getattr(error, "context_mark" if "could not find expected :" in problem else "problem_mark", None)
    if mark is None or not 0 <= mark.index <= len(text):
        return None
    number = source.position(mark.index)[0]
    line = source.line(number)
    if "expected key" in problem or "<block end>" in problem:
        return _bracketed(source, number, line)
    if "could not find expected :" in problem:
        return _without(source, number)
    if "mapping values are not allowed" in problem:
        before = line[: mark.index - source.line_starts[number - 1]]
        if (first := _COLON.search(before)) is not None:
            return _second(source, number, first.end(), mark.index)
        top = _top(source, number)
        return None if top == number else _without(source, top)
    return None


def _bracketed(source: Source, number: int, line: str) -> Fault | None:
    """``name:{`` or ``name {``."""
    head = _head(line)
    if (glued := _NO_SPACE.match(line, head)) is not None:
        message, help = "a space is missing behind this colon", f"write `{glued[1]}: {line[glued.end() :].rstrip()}`"
        return _line(source, number, head, glued.end() - 1, glued.end(), message, help)
    if (bare := _NO_COLON.match(line, head)) is not None:
        message, help = f"a colon is missing behind '{bare[1]}'", f"write `{bare[1]}: {line[bare.end() :].rstrip()}`"
        return _line(source, number, head, *bare.span(1), message, help)
    return None


def _without(source: Source, number: int) -> Fault:
    """A line that is a name or more without a colon."""
    line = source.line(number)
    head = _head(line)
    written = line[head:].split(" #")[0].rstrip()
    name, _, rest = written.partition(" ")
    help = f"write `{name}: {rest.strip()}`" if rest else f"write `{name}:` with what belongs to it below, indented"
    return _line(source, number, head, head, head + len(written), "a key without a colon", help)


def _second(source: Source, number: int, after: int, colon: int) -> Fault:
    """A value that holds a colon, from behind the first one on."""
    line = source.line(number)
    start = after + len(line[after:]) - len(line[after:].lstrip())
    message = "a second colon on this line, where no key can stand"
    help = f"fields on one line have brackets, `{{{line[start:].rstrip()}}}`; a text that holds a colon goes in quotes"
    at = colon - source.line_starts[number - 1]
    return _line(source, number, start, at, at + 1, message, help)


def _line(source: Source, number: int, start: int, caret: int, end: int, message: str, help: str) -> Fault:
    """The fault from column ``start`` on to the end of all that is indented below, its caret from ``caret`` to ``end``.

    What begins the line is no value: it is blank, and its mapping partial.
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


def _top(source: Source, number: int) -> int:
    """The first of the lines that YAML takes for one text with the key of a line: those before it without a colon."""
    line = source.line(number - 1) if number > 1 else ""
    while number > 1 and line.strip() and not line.lstrip().startswith("#") and _COLON.search(line) is None:
        number -= 1
        line = source.line(number - 1) if number > 1 else ""
    return number


def _head(line: str) -> int:
    found = _HEAD.match(line)
    return 0 if found is None else found.end()


def lacking(root: Node | None, faults: list[Fault]) -> None:
    """Mark what lacks the entry of a line that is left out: nothing is said of what seems to be missing there."""
    for fault in faults:
        if fault.blank != " " or not isinstance(root, Mapping) or fault.diagnostic is None:
            continue
        here: Mapping | None = root
        column = root.source.position(fault.start)[1]
        while here is not None:
            here.partial = True
            if any(root.source.position(key.start)[1] == column for key in here.keys.values()):
                break
            above = [node for node in here.entries.values() if isinstance(node, Mapping) and node.start < fault.start]
            here = max(above, key=lambda node: node.start, default=None)
