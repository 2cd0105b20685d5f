"""What to write instead of words of other programs without a counterpart in the language: for messages alone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from colorsys import hsv_to_rgb

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
_SIMPLE = re.compile(r"[\w.]+|\w+\([^()]*\)|\([^()]*\)")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_BLANK = re.compile(r"\{(\d)(!|-\d|\*\w+)?\}")
_ZERO = re.compile(r"0(?:\.0*)?\s*[^\W\d]*")
_SUM = re.compile(r"[-+<>=]")
HSV, TURN = ("hsv", "hsb", "hsv2rgb", "hsv_to_rgb"), 360.0
_CALLS = (
    ("if iif ifelse if_else select cond ternary", 3, "where({0}, {1}, {2})"),
    ("pow power", 2, "{0!}^{1!}"),
    ("sqr square", 1, "{0!}^2"),
    ("cbrt", 1, "{0!}^(1/3)"),
    ("frac fract", 1, "mod({0}, 1)"),
    ("fmod rem remainder modulo", 2, "mod({0}, {1})"),
    ("log2", 1, "log({0})/log(2)"),
    ("log", 2, "log({0})/log({1})"),
    ("atan arctan", 2, "atan2({0}, {1})"),
    ("saturate clamp01", 1, "clamp({0}, 0, 1)"),
    ("saturate constrain", 3, "clamp({0}, {1}, {2})"),
    ("lerp interpolate linear_interpolate", 3, "mix({0}, {1}, {2})"),
    ("map remap map_range maprange linmap rescale fit", 5, "mix({3}, {4}, clamp({0-1}/{2-1}, 0, 1))"),
    ("deg2rad degtorad radians deg_to_rad", 1, "{0*deg}"),
    ("rad2deg radtodeg degrees rad_to_deg", 1, "{0*rad}"),
    ("sind", 1, "sin({0*deg})"),
    ("cosd", 1, "cos({0*deg})"),
    ("tand", 1, "tan({0*deg})"),
    ("uniform rand_range random_range randf_range randint randrange random.range", 2, "mix({0}, {1}, random(1))"),
    ("float64 float32 float16 float int64 int32 int16 int8 uint8 double", 1, "{0}"),
    ("dist", 2, "distance({0}, {1})"),
    ("mag magnitude", 1, "length({0})"),
)
"""(names in small letters, how many arguments, what is written in place). `{0!}`: in brackets unless it is simple;
`{0*deg}`: as a quantity of that unit; `{0-1}`: the difference of two of them, in brackets unless it is simple."""
_TEXTS = {(name, count): text for names, count, text in _CALLS for name in names.split()}


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


def rewritten(name: str, args: Sequence[str]) -> str | None:
    """The call of a function of another language as it is written here; None where that is not known."""
    name = name.lower()
    if name in HSV and len(args) == 3 and all(map(_NUMBER.fullmatch, args)):
        return _color(*map(float, args))
    text = _TEXTS.get((name, len(args))) or _TEXTS.get((name.rpartition(".")[2], len(args)))
    if text is None or not all(args):
        return None

    def fill(blank: re.Match[str]) -> str:
        own, how = args[int(blank[1])].strip(), blank[2] or ""
        closed = own if _SIMPLE.fullmatch(own) or not how else f"({own})"
        if how.startswith("-"):
            less = args[int(how[1:])].strip()
            if _ZERO.fullmatch(less):
                return own if _SIMPLE.fullmatch(own) else f"({own})"
            return f"({own} - ({less}))" if _SUM.search(less) else f"({own} - {less})"
        if how.startswith("*"):
            return f"{own} {how[1:]}" if _NUMBER.fullmatch(own) else f"{closed}*(1 {how[1:]})"
        return closed

    return _BLANK.sub(fill, text)


def _color(hue: float, saturation: float, value: float) -> str:
    """The three numbers of a color by its hue, in turns or degrees, its saturation and value, in parts or percent."""
    hue = hue / TURN if hue > 1 else hue
    saturation, value = (one / 100 if one > 1 else one for one in (saturation, value))
    return f"[{', '.join(f'{one:.3g}' for one in hsv_to_rgb(hue, saturation, value))}]"
