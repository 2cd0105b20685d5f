"""Detection of values that YAML misreads: it knows no parentheses, takes ``#`` for a comment, ends a value at ``]``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from sceneql.language.behind_quotes import without_letters
from sceneql.language.tree import Scalar
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics
from sceneql.quantities.instead import instead
from sceneql.quantities.latex import from_latex
from sceneql.quantities.operations import FUNCTIONS
from sceneql.quantities.spaced import VECTORS, written_out
from sceneql.quantities.span import Source, Span

_MOST_SCANNED: Final = 20_000
_MOST_DEPTH: Final = 64
_MOST_FAULTS: Final = 20
_MOST_SHOWN: Final = 160
_CLOSES: Final = {"(": ")", "[": "]", "{": "}"}
_COLOR = re.compile(r"#(?:[0-9a-fA-F]{8}|[0-9a-fA-F]{6}|[0-9a-fA-F]{3,4})(?![^\s,\]}])")
_SWALLOWED = re.compile(rf"[ \t]+({_COLOR.pattern})")
_PROPERTY = re.compile(r"[&!][^\s,\[\]{}]*\s*")
_QUOTED = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^']|'')*'", re.DOTALL)
_CALLED = re.compile(r"(\w+)\(")
_UNIT = re.compile(r"[^\W\d_]|[%°]")
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_ITEM = r"(?:[^(),]|\([^(),]*\))+"
_LOOP = re.compile(r"\bfor\s+\w+\s+in\b")
_COPY = re.compile(r"([^\W\d]\w*)\[(\w+)\]((?:\.\w+)+)")
"""A value of a copy as other languages name it, ``ball[0].position``."""
_PARENTHESES = re.compile(rf"\(({_ITEM}(?:,{_ITEM})+)\)[ \t]*([^\W\d_][^()\[\]{{}},\s]*)?")
_ROTATION = re.compile(r"\brotation:\s*\Z")
_NAMED = re.compile(r"\$?\{\{?\s*([^\W\d][\w.]*)\s*\}\}?")
_INDEXED = re.compile(r"([^\W\d][\w.]*)\[\s*(\d+)\s*\]")
_COMMENT = re.compile(r"//|--|%(?=\s)")
_UNIT_IN_BRACKETS = re.compile(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?(?:\s+[-+]?[\d.]+)*)\s*\[\s*([^\W\d][^\[\],]*?)\s*\]")
_UNPARTED = re.compile(r"([^\W\d]\w*)(?:[ ]+|(:))(?=\[)")
_BLOCK_VALUE = re.compile(r"\s*(?:- +)*(?:[^\s\[{\"'#][^\[{\"'#]*?:\s+)?(?=[\[{])")


@dataclass(frozen=True, slots=True)
class Fault:
    """A misread value: characters ``start`` to ``end`` should read ``fixed``; the error's caret begins at ``caret``.

    A fault without a known repair carries a ``diagnostic`` instead. For another attempt of YAML each of its characters
    is replaced by ``blank``: part of a plain word, or a space.
    """

    code: str
    start: int
    end: int
    caret: int
    fixed: str
    diagnostic: Diagnostic | None = None
    blank: str = "x"


def swallowed(value: Scalar, text: str) -> Fault | None:
    """The fault of a color behind an empty value, which YAML took for a comment; None if there is none.

    ``text`` as in `broken_near`.
    """
    if (color := _SWALLOWED.match(text, value.end)) is None:
        return None
    start, end = color.span(1)
    return Fault("comment-color", start, end, start, f'"{color[1]}"')


def broken_halves(halves: Iterable[Scalar], text: str) -> list[Fault]:
    """Faults of expressions that commas of a flow collection cut, by their halves; ``text`` as in `broken_near`."""
    faults: list[Fault] = []
    for half in halves:
        if faults and half.start < faults[-1].end:
            continue
        with suppress(_LostError):
            scan = _Scan(text, half.source, min(len(text), half.start + _MOST_SCANNED))
            end, torn = scan.plain(half.start, nested=True)
            if torn:
                faults.append(scan.torn(half.start, end))
    return faults


def broken_near(source: Source, text: str, at: int, opening: int | None) -> list[Fault]:
    """Faults near ``at``, where YAML fails, inside the flow collection that opens at ``opening`` if any.

    ``text`` is the source's text with known faults blanked out.
    """
    if opening is None:
        start = max(text.rfind("\n", 0, at), text.rfind("\r", 0, at)) + 1
        value = _BLOCK_VALUE.match(text, start, at)
        if value is None:
            return []
        opening = value.end()
    scan = _Scan(text, source, min(len(text), opening + _MOST_SCANNED))
    with suppress(_LostError):
        scan.value(opening, 0)
    return scan.faults


def calls_another(text: str) -> bool:
    """Whether a value begins with a function of another language: where it is read, what stands here is told."""
    called = _CALLED.match(text)
    return called is not None and called[1] not in FUNCTIONS and instead("function", called[1]) is not None


def report(source: Source, faults: list[Fault], found: Diagnostics) -> None:
    """Report all faults, given in the order of the text, each with its line as corrected."""
    lines: dict[int, list[Fault]] = {}
    loops: dict[int, bool] = {}  # of each line, which may be long and hold many faults
    for fault in faults:
        lines.setdefault(source.position(fault.start)[0], []).append(fault)
    for together in lines.values():
        for fault in together:
            if fault.diagnostic is not None:
                found.add(fault.diagnostic)
                continue
            written = source.text[fault.caret : fault.end]
            if calls_another(written):
                continue  # it is reported where the value is read
            line = source.line(number := source.position(fault.caret)[0])
            if number not in loops:
                loops[number] = _LOOP.search(line) is not None
            if loops[number]:
                help = (
                    written_out(line.partition(": ")[2]) or f"values have no loops; of parts {instead('entry', 'for')}"
                )
                found.error("syntax", "'for' cannot stand in a value", Span(source, fault.caret, fault.end), help=help)
                continue
            if (named := _NAMED.fullmatch(written)) is not None:
                help = f"a name stands by itself: write `{named[1]}`"
                found.error(
                    "syntax", "'$' cannot stand in an expression", Span(source, fault.caret, fault.end), help=help
                )
                continue
            if (index := _INDEXED.fullmatch(written)) is not None:
                axis = "xyz"[min(int(index[2][:2]), 2)]
                help = f"write `item({index[1]}, {index[2]})`, in quotes; of a vector `{index[1]}.{axis}`"
                if index[1].rpartition(".")[2] in VECTORS:
                    help = f"write `{index[1]}.{axis}`"
                text = "brackets behind a name mean nothing here"
                found.error("syntax", text, Span(source, fault.caret, fault.end), help=help)
                continue
            line = _corrected(source, fault, together)
            match fault.code:
                case "comment-color":
                    message, help = f"{written} is read as a comment here, so the value is missing", f"quote it: {line}"
                case "unit-after-bracket":
                    message, help = f"the unit '{written}' cannot stand behind a bracket", f"write: {line}"
                case _ if "\\" in written and (plain := from_latex(written)) is not None:
                    message, help = "commands of LaTeX mean nothing here", f"write `{plain}`"
                    if source.text[: fault.start].rstrip().endswith("tex:"):
                        message, help = "TeX has braces, which are YAML's, too", f"quote it: `'{written}'`"
                case _ if _UNIT_IN_BRACKETS.fullmatch(written) is not None:
                    message, help = "a unit stands behind its number, without brackets", f"write: {line}"
                case _ if written.startswith("(") and fault.fixed[0] not in "\"'":
                    message, help = "a vector has no parentheses", f"write: {line}"
                case _ if _COPY.fullmatch(written) is not None:
                    message, help = "brackets behind a name mean nothing here", f"write `{fault.fixed}`"
                case _:
                    message, help = "YAML cuts this expression in two at a comma or bracket", f"quote it: {line}"
            found.error(fault.code, message, Span(source, fault.caret, fault.end), help=help)


def _corrected(source: Source, fault: Fault, together: list[Fault]) -> str:
    """The line of a fault with all its faults repaired; for a very long line, only the repaired value."""
    text = source.text
    first = source.line_starts[source.position(fault.start)[0] - 1]
    if fault.end - first > _MOST_SHOWN:
        return fault.fixed
    out, at = "", first
    for one in together:
        if one.start >= at:
            out += text[at : one.start] + one.fixed
            at = one.end
    last = source.position(at)[0]
    out += text[at : source.line_starts[last - 1] + len(source.line(last))]
    return out.strip() if len(out) <= _MOST_SHOWN else fault.fixed


class _LostError(Exception):
    """The text is not the flow syntax that the scan expects; faults found before stay valid."""


class _Scan:
    """Scanner of flow syntax as the author meant it: with parentheses, and with brackets inside expressions.

    ``text`` is the source's text, ``written``, with known faults blanked out.
    """

    def __init__(self, text: str, source: Source, end: int) -> None:
        self.text, self.source, self.written = text, source, source.text
        self.end = end
        self.faults: list[Fault] = []

    def peek(self, at: int) -> str:
        """The character at an offset; empty behind the end."""
        return self.text[at] if at < self.end else ""

    def value(self, at: int, depth: int, *, key: bool = False) -> int:
        """Read a value, or a ``key``; returns the offset of its end."""
        while (named := _PROPERTY.match(self.text, at, self.end)) is not None:
            at = named.end()
        character = self.peek(at)
        if character in ('"', "'"):
            quoted = _QUOTED.match(self.text, at, self.end)
            if quoted is None:
                raise _LostError
            return quoted.end()
        if character in ("[", "{"):
            end = self.collection(at, depth)
            return self.behind(at, end, depth)
        if (color := _COLOR.match(self.text, at, self.end)) is not None:
            self.faults.append(Fault("comment-color", at, color.end(), at, f'"{color[0]}"'))
            return color.end()
        end, torn = self.plain(at, nested=depth > 0)
        if torn:
            self.faults.append(self.torn(at, end, key=key))
        return end

    def torn(self, start: int, end: int, *, key: bool = False) -> Fault:
        """The fault of an expression that YAML cuts, of a ``key`` without a colon, or of a colon without a space."""
        written = self.written[start:end]
        if key and (unparted := _UNPARTED.match(written)) is not None:
            name, glued = unparted[1], unparted[2] is not None
            missing = "a space is missing behind this colon" if glued else f"a colon is missing behind '{name}'"
            caret = Span(self.source, start, end).part(*unparted.span(2 if glued else 1))
            diagnostic = Diagnostic("yaml-syntax", missing, caret, f"write `{name}: {written[unparted.end() :]}`")
            return Fault("yaml-syntax", start, end, caret.start, "", diagnostic)
        if key and calls_another(written):
            text, help = "a value stands here without a name", f"write `name: {written}`, or leave it out"
            return Fault(
                "yaml-syntax",
                start,
                end,
                start,
                "",
                Diagnostic("yaml-syntax", text, Span(self.source, start, end), help),
            )
        if (unit := _UNIT_IN_BRACKETS.fullmatch(written)) is not None:
            return Fault("torn-expression", start, end, start, f"{unit[1]} {unit[2]}")
        if (copy := _COPY.fullmatch(written)) is not None:
            name, number, rest = copy.groups()
            fixed = f"{name}.{number}{rest}" if number.isdecimal() else f'"{name}.{{{number}}}{rest}"'
            return Fault("torn-expression", start, end, start, fixed)
        vector = _PARENTHESES.fullmatch(written)  # as other languages write one
        fixed = _quote(written) if vector is None else _with_unit(vector[1], vector[2] or "")
        fixed = without_letters(written) or fixed
        return Fault("torn-expression", start, end, start, fixed)

    def collection(self, at: int, depth: int) -> int:
        """Read a list or mapping in brackets."""
        if depth > _MOST_DEPTH:
            raise _LostError
        closing = _CLOSES[self.text[at]]
        at += 1
        key = closing == "}"
        while True:
            at = self.space(at)
            character = self.peek(at)
            if character == closing:
                return at + 1
            if character in ("", "]", "}"):
                raise _LostError
            if character in (",", ":", "?"):
                key = closing == "}" and character != ":"
                at += 1
            else:
                at = self.value(at, depth + 1, key=key)
            if len(self.faults) >= _MOST_FAULTS:
                raise _LostError

    def space(self, at: int) -> int:
        """Skip blanks and comments, but not a color that looks like a comment; returns the offset behind."""
        while True:
            while self.peek(at).isspace():
                at += 1
            if self.peek(at) != "#" or _COLOR.match(self.text, at, self.end) is not None:
                return at
            end = self.text.find("\n", at, self.end)
            at = self.end if end < 0 else end

    def behind(self, start: int, close: int, depth: int) -> int:
        """Read on behind a closing bracket, where nothing else should stand on the line; returns the end."""
        at = close
        while self.peek(at) in (" ", "\t"):
            at += 1
        if self.peek(at) in ("", "\n", "\r", "#", ",", ":", "]", "}"):
            return close
        end, _ = self.plain(at, nested=depth > 0)
        rest = self.text[at:end]
        if rest == ";":
            caret = Span(self.source, at, end)
            ended = Diagnostic("yaml-syntax", "nothing can stand behind this bracket", caret, "leave out the `;`")
            self.faults.append(Fault("yaml-syntax", at, end, at, "", ended, " "))
            return end
        sign = _COMMENT.match(rest)
        if sign is not None and (sign[0] == "//" or self.text[start] == "{"):
            caret = Span(self.source, at, end)
            help = f"a comment begins with `#`: write `#{rest[sign.end() :]}`"
            comment = Diagnostic("yaml-syntax", "nothing can stand behind this bracket", caret, help)
            self.faults.append(Fault("yaml-syntax", at, end, at, "", comment, " "))
            return end
        # Faults inside are part of this one, which quotes the whole value or writes it anew.
        self.faults = [fault for fault in self.faults if fault.start < start]
        if self.text[start] == "[" and _UNIT.match(rest) is not None:
            fixed = _with_unit(self.written[start + 1 : close - 1], rest)
            if _ROTATION.search(self.text, max(0, start - _MOST_SHOWN), start) and not fixed.startswith("["):
                fixed = f"{{xyz: {fixed}}}"
            self.faults.append(Fault("unit-after-bracket", start, end, at, fixed))
        else:
            self.faults.append(self.torn(start, end))
        return end

    def plain(self, at: int, *, nested: bool) -> tuple[int, bool]:
        """Read a plain scalar; returns its end, and whether YAML would end it sooner."""
        open_brackets: list[str] = []
        torn = False
        start = at
        while (character := self.peek(at)) != "":
            following = self.peek(at + 1)
            if character == ":" and (following.isspace() or following in ("", ",", "]", "}")):
                if open_brackets:
                    raise _LostError
                break
            if character == "#" and self.text[at - 1].isspace():
                break
            if not open_brackets and (character in "\r\n" or (nested and character in ",]}")):
                break
            if character in _CLOSES:
                torn = torn or character != "("
                open_brackets.append(_CLOSES[character])
            elif character in ")]}":
                if not open_brackets or open_brackets.pop() != character:
                    raise _LostError
            elif character == "," and open_brackets:
                torn = True
            at += 1
        if open_brackets:
            raise _LostError
        return start + len(self.text[start:at].rstrip()), torn


def _quote(text: str) -> str:
    text = " ".join(text.split())
    if '"' in text or "\\" in text:
        return "'" + text.replace("'", "''") + "'"
    return f'"{text}"'


def _with_unit(inside: str, unit: str) -> str:
    """A list with its unit, if any, as YAML allows it: ``0, 1, 0`` in m becomes ``0 1 0 m``."""
    items = _split(inside)
    if all(NUMBER.fullmatch(item) for item in items):
        return " ".join([*items, unit]).rstrip()
    written = []
    for item in items:
        if item.startswith("[") and item.endswith("]"):
            written.append(_with_unit(item[1:-1], unit))
        else:
            written.append(f"{item} {unit}".rstrip() if NUMBER.fullmatch(item) else item)
    text = f"[{', '.join(written)}]"
    return _quote(text) if any("(" in item and "," in item for item in written) else text


def _split(text: str) -> list[str]:
    """The items of a text, separated by commas outside of brackets."""
    items, depth, start = [], 0, 0
    for at, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            items.append(text[start:at].strip())
            start = at + 1
    return [*items, text[start:].strip()]
