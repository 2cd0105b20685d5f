"""What to write instead of words of other programs without a counterpart in the language: for messages alone."""

from __future__ import annotations

import re

from sceneql.quantities.dimension import ANGLE, FREQUENCY, TEMPERATURE, Dimension
from sceneql.quantities.instead_in_formulas import OF_FORMULAS, OF_NAMED
from sceneql.quantities.instead_of_sections import OF_SECTIONS
from sceneql.quantities.instead_of_words import OF_PARTS

INSTEAD = {
    (what, word): text
    for kinds, words, text in (*OF_FORMULAS, *OF_PARTS, *OF_NAMED, *OF_SECTIONS)
    for what in kinds.split()
    for word in words.split()
}
"""The sentence of what to write in place of a called `function`, a `sign` or `name` of a formula, `behind` a number
of it or `before` its rest, the `field` of a part, or `field.FAMILY`, a `section` of the script, the key of an
`entry` or the name of one (`named`)
or one `beside` its word, a field of `keys`, a `unit`, a `body` of a tie, a `zero`, a `bare` text in place of fields, or
a word of a family, by the family's name."""

_ANGLES = re.compile(r"[-+.\de\s]+(deg|rad)")
_TURNING = re.compile(r"([-+.\d]+)\s*\*\s*time|time\s*\*\s*([-+.\d]+)")
_UNIT = re.compile(r"\d\s*([^\W\d]\w*)\s*$")
_TENS = re.compile(r"(?<![\w.])(\d+\.?\d*)\s*[x×·⋅*]\s*10\s*(?:\^|\*\*)\s*\(?([-+−]?\d+)")
_SEVERAL = {"", "ties", *(what for what, _ in INSTEAD)}
"""Families, which a sentence on fields may be of."""
_T = re.compile(r"(?<=[*/])t(?!\w)")
_TON = re.compile(r"\d\s*[^\s()\[\],]*[*/]t(?!\w)")


def time_meant(text: str) -> str | None:
    """The help for a quantity in which ``t`` is read as a tonne though most likely the time was meant: ``2 m/s*t``."""
    if _TON.search(text) is None:
        return None
    meant = _T.sub("time", text.strip())
    return f"the time is `time`: write `{meant}`"


def instead(what: str, word: str) -> str | None:
    """The help for a word of another program that is taken for ``what`` (a key of `INSTEAD`), if known."""
    word = word.removesuffix("()")
    return INSTEAD.get((what, word)) or INSTEAD.get((what, word.lower()))


def anywhere(word: str) -> str | None:
    """The help for a word of another program, whatever it was meant as, but a field of a single word alone."""
    found = [
        (what, help)
        for (what, other), help in INSTEAD.items()
        if other == word.lower() and what != "before" and what.partition(".")[2] in _SEVERAL
    ]
    return min(found, key=lambda one: "." in one[0], default=("", None))[1]


def unit_meant(text: str, has: Dimension | None, wanted: Dimension | None) -> str | None:
    """The help for a text of one dimension where another is wanted, as ``90 deg``, or ``45*time``, for one by time."""
    if (tonne := time_meant(text)) is not None or has is None or wanted is None:
        return tonne
    if has.kind == ANGLE.kind and wanted == FREQUENCY and _ANGLES.fullmatch(text) is not None:
        return f"it goes by time: write `{text}/s`"
    if wanted.kind == ANGLE.kind and (turning := _TURNING.fullmatch(text.strip())) is not None:
        return f"write `{turning[1] or turning[2]} deg/s*time`"
    if wanted == TEMPERATURE and has.kind == ANGLE.kind and text.endswith("deg"):
        return f"write `{text[:-3].strip()} °C`"
    if wanted == TEMPERATURE and text[-1:] in ("C", "F"):
        return f"write `{text[:-1].strip()} °{text[-1]}`"
    return None


def of_unit(text: str) -> str | None:
    """The help for a number with a unit that is measured otherwise here: ``800 lm``."""
    found = _UNIT.search(text)
    return None if found is None else instead("unit", found[1])


def power_of_ten(text: str) -> str | None:
    """The help for a number times a power of ten, ``5.97x10^24 kg``."""
    ten = _TENS.search(text)
    return None if ten is None else f"write `{ten[1]}e{ten[2]}`, with the unit behind it"
