"""Errors as data: each has a code, a place with a caret, and a help line; all of a script's come in one run."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from sceneql.quantities.other_words import LIBRARIES, OURS
from sceneql.quantities.span import Span

LIMITS = frozenset(
    {
        "alias-expansion",
        "expression-too-deep",
        "expression-too-long",
        "limit-refused",
        "too-deep",
        "too-large",
        "too-many-parts",
    }
)
"""Codes of errors that refuse a script for its size, whether or not it is right otherwise."""


@dataclass(frozen=True, slots=True)
class Note:
    """A second place that a diagnostic speaks of."""

    message: str
    span: Span


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One error or warning. ``code`` is a lasting kebab-case name such as ``unknown-field``."""

    code: str
    message: str
    span: Span | None
    help: str | None = None
    notes: tuple[Note, ...] = ()
    severity: Literal["error", "warning"] = "error"

    def __str__(self) -> str:
        lines = [f"{self.severity}[{self.code}]: {_cut(self.message)}"]
        if self.span is not None:
            lines += _excerpt(self.span)
        for note in self.notes:
            lines += [f"note: {_cut(note.message)}", *_excerpt(note.span)]
        if self.help is not None:
            lines.append(f"help: {_cut(self.help)}")
        return _shown("\n".join(lines))


LONGEST_WORD, LONGEST_TEXT = 80, 1000
"""Most characters of a word, and of a whole line, of a message: a script's names may be megabytes long."""
_PIECE = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_LONG_WORD = re.compile(rf"\S{{{LONGEST_WORD + 1},}}")


def _cut(text: str) -> str:
    """A message whose echoes of the script are cut, with an ellipsis, to a length that one reads."""
    text = _LONG_WORD.sub(lambda word: f"{word[0][: LONGEST_WORD // 2]}...{word[0][-LONGEST_WORD // 4 :]}", text)
    return text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - LONGEST_WORD]} ... {text[-LONGEST_WORD:]}"


def _shown(text: str) -> str:
    # A script may hold escape sequences that would drive the terminal.
    return "".join(c if c.isprintable() or c == "\n" else "\ufffd" for c in text)


def _excerpt(span: Span) -> list[str]:
    line, column = span.source.position(span.start)
    full = span.source.line(line)
    # A line of a generated script may be megabytes long: show a window around the caret.
    first = max(0, column - 1 - 60) if len(full) > 160 else 0
    text = full[first : first + 160].expandtabs(1)
    shift = column - 1 - first
    width = max(1, min(span.end - span.start, len(text) - shift))
    number = str(line)
    gutter = " " * len(number)
    return [f"{gutter}--> {span}", f"{gutter} |", f"{number} | {text}", f"{gutter} | {' ' * shift}{'^' * width}"]


class ScriptError(Exception):
    """A script that cannot be used; carries every diagnostic found."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__("\n\n".join(str(d) for d in self.diagnostics))


class Diagnostics:
    """Collects what is wrong, in the order found; a repeated (code, place, message) is kept once."""

    def __init__(self) -> None:
        self.found: list[Diagnostic] = []
        self._seen: set[tuple[str, str, object]] = set()

    def add(self, diagnostic: Diagnostic) -> None:
        """Keep a diagnostic unless the same one was found before."""
        key = (diagnostic.code, diagnostic.message, _where(diagnostic))
        if key not in self._seen:
            self._seen.add(key)
            self.found.append(diagnostic)

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Keep the diagnostics of a caught error, so that later ones are reported with them."""
        for diagnostic in diagnostics:
            self.add(diagnostic)

    def error(
        self, code: str, message: str, span: Span | None, *, help: str | None = None, notes: Iterable[Note] = ()
    ) -> None:
        """Record an error."""
        self.add(Diagnostic(code, message, span, help, tuple(notes)))

    def warning(
        self, code: str, message: str, span: Span | None, *, help: str | None = None, notes: Iterable[Note] = ()
    ) -> None:
        """Record a warning; it does not stop anything."""
        self.add(Diagnostic(code, message, span, help, tuple(notes), "warning"))

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The errors alone."""
        return tuple(d for d in self.found if d.severity == "error")

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The warnings alone."""
        return tuple(d for d in self.found if d.severity == "warning")

    def raise_errors(self) -> None:
        """Raise ScriptError with all of the errors, in the order of the text, if there are any."""
        if self.errors:
            raise ScriptError(sorted(self.errors, key=_place))


def told_once(tries: Sequence[Iterable[Diagnostic]]) -> list[Diagnostic]:
    """The errors of many variants of one script: what several have at one place, or word for word, once with a count.

    A value that a thousand variants set too low is one error at the field that it stands for, not a thousand.
    """
    firsts: dict[object, Diagnostic] = {}
    counts: dict[int, int] = {}
    for each in tries:
        seen: set[int] = set()
        here: dict[object, int] = {}
        for diagnostic in each:
            at = diagnostic.code, _where(diagnostic)
            here[at] = here.get(at, 0) + 1
            text, place = (diagnostic.code, diagnostic.message), (*at, here[at])
            first = firsts.get(text) or firsts.get(place) or diagnostic
            firsts[text] = firsts[place] = first
            seen.add(id(first))
        for one in seen:
            counts[one] = counts.get(one, 0) + 1
    result = []
    for diagnostic in {id(each): each for each in firsts.values()}.values():
        count = counts[id(diagnostic)]
        more = f" (so or alike in {count} variants)" if count > 1 else ""
        result.append(replace(diagnostic, message=diagnostic.message + more))
    return result


def _where(diagnostic: Diagnostic) -> object:
    span = diagnostic.span
    return None if span is None else (span.source.name, span.start, span.end)


def _place(diagnostic: Diagnostic) -> tuple[str, int]:
    span = diagnostic.span
    return ("", -1) if span is None else (span.source.name, span.start)


def same_as(name: str, choices: Collection[str]) -> str | None:
    """The choice that a name is, but for capitals, or that another program calls so (``pos``), if any."""
    return next(iter(all_same_as(name, choices)), None)


def all_same_as(name: str, choices: Collection[str]) -> list[str]:
    """As `same_as`, all of them, the likeliest first."""
    name = of_library(name)
    close = [choice for choice in choices if choice.lower() == name.lower()]
    return close or [ours for ours in OURS.get(name.lower(), ()) if ours in choices]


def of_library(name: str) -> str:
    """A name without that of a library before its dot: ``sin`` of ``Math.sin``."""
    library, _, inside = name.partition(".")
    return inside if inside and library in LIBRARIES else name


STRONG = 0.8
"""Least likeness of names that are most likely the same but for a slip of the hand; below it they may be two things."""


def nearest(name: str, choices: Iterable[str], least: float = 0.6) -> str | None:
    """The choice that is most like the name, means the same (``pos``) or is abbreviated by it (``fov``), if any.

    ``least``: least likeness of the letters, from 0 to 1.
    """
    from difflib import get_close_matches

    if len(name) > LONGEST_WORD:
        return None
    choices = list(choices)
    if (same := same_as(name, choices)) is not None:
        return same
    if "(" in name:  # new THREE.SphereGeometry(1, 32, 32)
        name = re.split(r"[\s.]", name.partition("(")[0])[-1]
    name = of_library(name)
    close = get_close_matches(name, choices, n=1, cutoff=STRONG)
    pieces = [] if "." in name else _PIECE.findall(name)
    if not close and len(pieces) > 1:  # AmbientLight, primitive_cube_add
        close = [same for piece in pieces if (same := same_as(piece, choices)) is not None][:1]
    close = close or get_close_matches(name, choices, n=1, cutoff=least)
    if not close and len(name) > 1:
        close = [choice for choice in choices if name == "".join(part[:1] for part in choice.split("_"))]
    return close[0] if close else None


def suggestion(name: str, choices: Iterable[str], least: float = 0.6) -> str | None:
    """``did you mean 'radius'?`` for the nearest of the choices, or None; ``least`` as of `nearest`."""
    close = nearest(name, choices, least)
    return None if close is None else f"did you mean '{close}'?"
