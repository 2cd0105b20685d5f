"""Repairs: broken values are read as meant, and the complete entries kept of a text that stops being YAML."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from sceneql.language.broken_values import NUMBER, Fault, calls_another
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, hole
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.parser import parse_value
from sceneql.quantities.span import Source, Span

_LAID_FLAT: Final = str.maketrans("[],\r\n\t", "      ")


def joined(faults: Iterable[Fault], more: Iterable[Fault]) -> list[Fault]:
    """Old and new faults in the order of the text, without old ones that lie inside a new one."""
    more = list(more)
    kept = [old for old in faults if not any(new.start <= old.start and old.end <= new.end for new in more)]
    return sorted([*kept, *more], key=lambda fault: fault.start)


def blanked(text: str, faults: Iterable[Fault]) -> str:
    """The text with a plain word or spaces of the same length in place of each fault, so that YAML reads the rest."""
    parts, at = [], 0
    for fault in faults:
        if fault.start >= at:
            parts += [text[at : fault.start], fault.blank * (fault.end - fault.start)]
            at = fault.end
    return "".join([*parts, text[at:]])


def repaired(fault: Fault, source: Source) -> Node:
    """The value that a fault was meant to be; a hole where that is not known."""
    span = Span(source, fault.start, fault.end)
    if fault.code == "unit-after-bracket" and fault.fixed.startswith("{"):
        return hole(span)  # a rotation, of which the fixed text says all
    if fault.code == "unit-after-bracket":
        inside = Span(source, fault.start, source.text.rindex("]", fault.start, fault.caret) + 1)
        return _with_unit(inside, source.text[fault.caret : fault.end]) or hole(span)
    unread = fault.code == "torn-expression" and not (_sound(span.text, span) or calls_another(span.text))
    if fault.diagnostic is not None or unread:
        return hole(span)
    return Scalar(" ".join(span.text.split()), "text", False, source, fault.start, fault.end)


def _sound(text: str, span: Span) -> bool:
    """Whether the text parses as an expression; names in it may be unknown, which is an error of its own."""
    try:
        parse_value(text, span)
    except ScriptError as error:
        return all(diagnostic.code != "syntax" for diagnostic in error.diagnostics)
    return True


def _with_unit(list_: Span, unit: str) -> Node | None:
    """A list of numbers, or of such lists, with the unit on each row; None where other items stand in it."""
    text = list_.text
    try:
        parse_value(f"1 {unit}", list_)
    except ScriptError:
        return None
    if all(NUMBER.fullmatch(item.strip()) for item in text[1:-1].split(",")):
        # Of the same length as the written text, so that carets point into it.
        flat = f"{text.translate(_LAID_FLAT)} {unit}"
        return Scalar(flat, "text", False, list_.source, list_.start, list_.end)
    rows: list[Node] = []
    at = 1
    while (first := text.find("[", at)) >= 0:
        last = text.find("]", first)
        row = _with_unit(list_.part(first, last + 1), unit)
        if row is None or text[at:first].strip(" \t\r\n,"):
            return None
        rows.append(row)
        at = last + 1
    if not rows or text[at:-1].strip(" \t\r\n,"):
        return None
    return Sequence(rows, True, list_.source, list_.start, list_.end)


def cut_short(stack: list[Mapping | Sequence], keyed: bool, at: int) -> None:
    """Drop incomplete entries where reading stopped: ``stack`` holds the collections open there, outermost first.

    The open section keeps its complete entries. ``keyed``: the next key was already read, so the value before it is
    complete. ``at`` is the offset where reading stopped: a value on that line may be cut.
    """
    if not isinstance(root := stack[0], Mapping):
        return
    root.partial = True
    section = stack[min(1, len(stack) - 1)]
    if len(stack) > 2 or (not keyed and _doubtful(section, at)):
        _drop_last(section)
    if isinstance(section, Mapping):
        section.partial = True


def _doubtful(collection: Mapping | Sequence, at: int) -> bool:
    """Whether the last value may be wrong: a plain scalar may hold too much text, and any value may end at ``at``."""
    values = collection.items if isinstance(collection, Sequence) else [*collection.entries.values()]
    if not values:
        return False
    last = values[-1]
    plain = isinstance(last, Scalar) and not last.quoted
    return plain or "\n" not in last.source.text[last.end : at]


def _drop_last(collection: Mapping | Sequence) -> None:
    if isinstance(collection, Sequence):
        del collection.items[-1:]
    elif collection.entries:
        name, _ = collection.entries.popitem()
        del collection.keys[name]
