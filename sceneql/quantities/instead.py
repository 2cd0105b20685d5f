"""What to write instead of words of other programs without a counterpart in the language: for messages alone."""

from __future__ import annotations

import re

from sceneql.quantities.instead_in_formulas import OF_FORMULAS
from sceneql.quantities.instead_of_sections import OF_SECTIONS
from sceneql.quantities.instead_of_words import OF_PARTS

INSTEAD = {
    (what, word): text
    for kinds, words, text in (*OF_FORMULAS, *OF_PARTS, *OF_SECTIONS)
    for what in kinds.split()
    for word in words.split()
}
"""The sentence of what to write in place of a called `function`, a `sign` or `name` of a formula, `behind` a number
of it or `before` its rest, the `field` of a part, or `field.FAMILY`, a `section` of the script, the key of an `entry`
or one `beside` its word, a field of `keys`, a `unit`, a `body` of a tie, a `zero`, a `bare` text in place of fields, or
a word of a family, by the family's name."""

_TON = re.compile(r"\d\s*[^\s()\[\],]*[*/]t(?!\w)")


def time_meant(text: str) -> str | None:
    """The help for a quantity in which ``t`` is read as a tonne though most likely the time was meant: ``2 m/s*t``."""
    return "the time is `time`: `t` behind a unit is 1000 kg" if _TON.search(text) is not None else None


def instead(what: str, word: str) -> str | None:
    """The help for a word of another program that is taken for ``what`` (a key of `INSTEAD`), if known."""
    return INSTEAD.get((what, word)) or INSTEAD.get((what, word.lower()))


def anywhere(word: str) -> str | None:
    """The help for a word of another program, whatever it was meant as."""
    found = [(what, help) for (what, other), help in INSTEAD.items() if other == word.lower() and what != "before"]
    return min(found, key=lambda one: "." in one[0], default=("", None))[1]
