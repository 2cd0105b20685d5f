"""Errors as data: each has a code, a place with a caret, and a help line; all of a script's come in one run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

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
        lines = [f"{self.severity}[{self.code}]: {self.message}"]
        if self.span is not None:
            lines += _excerpt(self.span)
        for note in self.notes:
            lines += [f"note: {note.message}", *_excerpt(note.span)]
        if self.help is not None:
            lines.append(f"help: {self.help}")
        return _shown("\n".join(lines))


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
        span = diagnostic.span
        place = None if span is None else (span.source.name, span.start, span.end)
        key = (diagnostic.code, diagnostic.message, place)
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


def _place(diagnostic: Diagnostic) -> tuple[str, int]:
    span = diagnostic.span
    return ("", -1) if span is None else (span.source.name, span.start)


def nearest(name: str, choices: Iterable[str]) -> str | None:
    """The choice that is most like the name, or that it abbreviates (``fov``); None where none is."""
    from difflib import get_close_matches

    choices = list(choices)
    initials = [choice for choice in choices if name == "".join(part[:1] for part in choice.split("_"))]
    close = get_close_matches(name, choices, n=1, cutoff=0.6) or (initials if len(name) > 1 else [])
    return close[0] if close else None


def suggestion(name: str, choices: Iterable[str]) -> str | None:
    """``did you mean 'radius'?`` for the nearest of the choices, or None."""
    close = nearest(name, choices)
    return None if close is None else f"did you mean '{close}'?"
