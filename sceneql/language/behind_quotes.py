"""Texts as other languages put values into them: behind the closing quote, or with a letter before the first."""

from __future__ import annotations

import re
from typing import Final

_VALUE = re.compile(r"[^\W\d]\w*(?:\.\w+)+")
_PLACE = re.compile(r"%(?P<form>[-+ #0-9]*(?:\.\d+)?[a-zA-Z])(?P<unit> ?[^\W\d][\w/^*]*)?|\{(?::(?P<own>[^{}]*))?\}")
_LETTERS = re.compile(r"[fFrRbBuU]{1,2}(?=([\"']).*\1$)", re.DOTALL)
_QUOTED = re.compile(r"(?P<quote>[\"'])(?P<text>[^\"'\n]*)(?P=quote)[ \t]*$")
_JOINED: Final = ("%", "+", ".")


def without_letters(text: str) -> str | None:
    """The quoted text behind the letters of an ``f"..."`` or ``r'...'``; None where none stand before its quotes."""
    letters = _LETTERS.match(text)
    return None if letters is None else text[letters.end() :]


def told_behind(text: str, at: int) -> str | None:
    """The text as a script writes it, where values behind its quotes are to be put into it: ``"E = %.2f J" % E``.

    ``at`` is where ``text`` goes on behind the closing quote; None where a quoted text does not end there so.
    """
    quoted = _QUOTED.search(text, text.rfind("\n", 0, at) + 1, at)
    rest = text[at : text.find("\n", at) if "\n" in text[at:] else len(text)]
    if quoted is None or not rest.startswith(_JOINED):
        return None
    names = _VALUE.findall(rest.removeprefix(".format")) or ["ball.position.y"]
    written = quoted["text"]
    for name in names:
        place = _PLACE.search(written)
        if place is None:
            written = f"{written}{{{name}}}"
            continue
        form = (place["form"] or place["own"] or "").replace("s", "").replace("d", ".0f")
        unit = place["unit"] or ""
        written = (
            f"{written[: place.start()]}{{{name}{':' if form or unit else ''}{form}{unit}}}{written[place.end() :]}"
        )
    return f'"{written}"'
